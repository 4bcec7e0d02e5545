"""What other programs' viewers draw, decoded by the schemas in the file and, where they are there, the public ones."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader
from support.helix_run import HEADER, THRUSTERS, append_tick, fly, model, places_and_axes, pod_model, table

from cube_sim.recording.mcap.viewer_layout import viewer_layout
from cube_sim.recording.recorder import Recorder

TICKS = 700  # 14 s


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with Recorder(tmp_path_factory.mktemp("run"), HEADER, table(), model(), view=False) as recorder:
        fly(recorder, TICKS)
    return recorder


def of_the_file(schema):
    """The class of a message by the descriptors that the recording itself carries."""
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(schema.data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))


def public(schema):
    """The class as its authors publish it."""
    package, _, name = schema.name.partition(".")
    assert package == "foxglove"
    return getattr(pytest.importorskip(f"foxglove_schemas_protobuf.{name}_pb2"), name)


@pytest.fixture(scope="module", params=[of_the_file, public])
def messages(run, request):
    found = {}
    with run.mcap.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            if channel.topic.startswith(("/scene", "/tf")):
                decoded = request.param(schema).FromString(message.data)
                found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return found


def turned(q) -> np.ndarray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array([q.w, q.x, q.y, q.z]))
    return matrix.reshape(3, 3)


def test_what_stands_still_is_one_message_of_its_topic(messages):
    assert {topic: len(each) for topic, each in messages.items()} == {
        "/scene": 1,
        "/scene/path": 1,
        "/scene/trail": 3,
        "/scene/thrust": 140,
        "/tf": TICKS,
        "/tf/target": 28,
    }


def test_the_hull_is_that_of_the_model_in_the_frame_of_the_vehicle(messages):
    ((_, scene),) = messages["/scene"]
    hull, target = scene.entities
    assert (hull.frame_id, hull.frame_locked, target.frame_id) == ("octa", True, "target")
    (box,) = hull.cubes
    assert (box.size.x, box.size.y, box.size.z) == (0.5, 0.5, 0.5)
    tube, *ducts = hull.cylinders
    assert np.array([tube.size.x, tube.size.z]) == pytest.approx([0.12, 0.52])
    assert abs(turned(tube.pose.orientation)[:, 2]) == pytest.approx([1, 0, 0], abs=1e-12)
    assert len(ducts) == len(THRUSTERS)
    assert len(target.arrows) == 1


def test_the_path_is_the_recorded_one(run, messages):
    ((_, scene),) = messages["/scene/path"]
    (line,) = scene.entities[0].lines
    points = [[point.x, point.y, point.z] for point in line.points]
    assert np.array_equal(points, run.signals["path.points"][0, 1:].reshape(-1, 3))
    assert scene.entities[0].frame_id == "world"


def test_arrows_are_forces_along_the_axes_of_the_thrusters(run, messages):
    compiled = model()
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    axes = np.array([data.site(name).xmat.reshape(3, 3)[:, 2] for name in THRUSTERS])
    force = run.signals["thrusters.force"]
    scales = set()
    for stamp, scene in messages["/scene/thrust"]:
        at = np.argmin(np.abs(force[:, 0] - (stamp / 1e9 - 946_684_800)))
        for arrow, axis, push in zip(scene.entities[0].arrows, axes, force[at, 1:], strict=True):
            np.testing.assert_allclose(turned(arrow.pose.orientation)[:, 0], (1 if push >= 0 else -1) * axis, atol=1e-9)
            if abs(push) > 10:
                scales.add(round(arrow.shaft_length / abs(push), 2))
    assert len(scales) == 1


def test_thrusters_on_what_the_hull_carries_are_drawn_where_they_push(tmp_path):
    with Recorder(tmp_path, HEADER, table(), pod_model(), view=False) as recorder:
        fly(recorder, 60)
    places, axes = places_and_axes(pod_model())
    force, scenes = recorder.signals["thrusters.force"], 0
    with recorder.mcap.open("rb") as stream:
        for schema, _, message in make_reader(stream).iter_messages(["/scene/thrust"]):
            arrows = of_the_file(schema).FromString(message.data).entities[0].arrows
            at = np.argmin(np.abs(force[:, 0] - (message.log_time / 1e9 - 946_684_800)))
            for arrow, place, axis, push in zip(arrows, places, axes, force[at, 1:], strict=True):
                origin = arrow.pose.position
                np.testing.assert_allclose([origin.x, origin.y, origin.z], place, atol=1e-9)
                way = turned(arrow.pose.orientation)[:, 0]
                np.testing.assert_allclose(way, (1 if push >= 0 else -1) * axis, atol=1e-9)
            scenes += 1
    assert scenes == 12


def test_the_target_and_the_trail_are_where_they_were(run, messages):
    target = run.signals["target.position"]
    for stamp, frame in messages["/tf/target"]:
        at = np.argmin(np.abs(target[:, 0] - (stamp / 1e9 - 946_684_800)))
        shown = [frame.translation.x, frame.translation.y, frame.translation.z]
        np.testing.assert_allclose(shown, target[at, 1:], atol=1e-3)
        assert (frame.parent_frame_id, frame.child_frame_id) == ("world", "target")
        assert frame.timestamp.seconds * 10**9 + frame.timestamp.nanos == stamp
    position = run.signals["pose.position"][:, 1:]
    stamp, scene = messages["/scene/trail"][-1]
    (line,) = scene.entities[0].lines
    ends = np.array([[point.x, point.y, point.z] for point in line.points])
    assert np.array_equal(ends[1:-1:2], ends[2::2])
    for end in ends:
        assert np.abs(position - end).max(axis=1).min() < 1e-3
    np.testing.assert_allclose(ends[-1], position[round((stamp / 1e9 - 946_684_800) / 0.02)], atol=1e-3)


def test_no_trail_leads_across_ticks_that_are_missing(tmp_path):
    """As in a record that was damaged, and recovered."""
    with Recorder(tmp_path, HEADER, table(), model(), view=False) as recorder:
        for k in [*range(200), *range(500, TICKS)]:
            append_tick(recorder, k)
    with recorder.mcap.open("rb") as stream:
        found = list(make_reader(stream).iter_messages(["/scene/trail"]))
    schema, _, message = found[-1]
    (line,) = of_the_file(schema).FromString(message.data).entities[0].lines
    ends = np.array([[point.x, point.y, point.z] for point in line.points]).reshape(-1, 2, 3)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    position = recorder.signals["pose.position"]
    lost = np.linalg.norm(position[200, 1:] - position[199, 1:])
    assert 0 < lengths.max() < 0.5 * lost
    assert np.count_nonzero(lengths) == 3  # a piece a second before the gap, and none to its end


def test_the_layout_shows_topics_and_numbers_that_there_are(run):
    layout = json.loads(viewer_layout(table(), "octa"))
    with run.mcap.open("rb") as stream:
        reader = make_reader(stream)
        classes = {channel.topic: of_the_file(schema) for schema, channel, _ in reader.iter_messages()}
    panels = layout["configById"]
    assert set(panels["3D!scene"]["topics"]) <= classes.keys()
    paths = [series["value"] for panel in panels.values() for series in panel.get("paths", ())]
    assert len(paths) == 2 + len(THRUSTERS) + 6
    for path in paths:
        topic, *names = path.split(".")
        descriptor = classes[topic].DESCRIPTOR
        for name in names[:-1]:
            descriptor = descriptor.fields_by_name[name].message_type
        assert descriptor.fields_by_name[names[-1]].cpp_type == descriptor.fields_by_name[names[-1]].CPPTYPE_DOUBLE
    shown = json.dumps(layout["layout"])
    assert all(name in shown for name in panels)
