from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from support.helix_run import (
    DT,
    HEADER,
    MJCF,
    POD_MJCF,
    THRUSTERS,
    append_tick,
    fly,
    model,
    places_and_axes,
    pod_model,
    table,
)

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, split_into_batches
from cube_sim.recording.channels import channel_table
from cube_sim.recording.export import rrd_from_mcap
from cube_sim.recording.geometry import thruster_mounts, vehicle_name, vehicle_reach, vehicle_shapes, world_shapes
from cube_sim.recording.reading import read_recording
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.rerun import sink
from cube_sim.recording.rerun.gathering import GatheringSink
from cube_sim.recording.rerun.parts import Parts
from cube_sim.recording.rerun.places import Places
from cube_sim.recording.rerun.scene import ARROW_M_PER_M_S
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine
from cube_sim.verdict import CheckResult

CURRENT_M_PER_M_S = ARROW_M_PER_M_S * vehicle_reach(model())
TICKS = 330  # 6.6 s: pieces of five seconds join in the middle of the run


def rerun(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the viewer's own command line."""
    (folder,) = find_spec("rerun_cli").submodule_search_locations
    binary = Path(folder) / ("rerun.exe" if sys.platform == "win32" else "rerun")
    return subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def drawn(rrd: Path, entity: str, component: str) -> tuple[np.ndarray, list]:
    """Read a component back from the file: the times [s] and one list of values for each."""
    rows = []
    for chunk in RrdReader(rrd).stream():
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and component in batch.schema.names and not chunk.is_static:
            times = batch.column("sim_time").cast("int64").to_numpy()
            rows += zip(times, batch.column(component).to_pylist(), strict=True)
    rows.sort(key=lambda row: row[0])
    return np.array([t for t, _ in rows]) / 1e9, [values for _, values in rows]


def still(rrd: Path, entity: str, component: str) -> list:
    """Read a static component back."""
    found = []
    for chunk in RrdReader(rrd).stream():
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and component in batch.schema.names and chunk.is_static:
            found += batch.column(component).to_pylist()
    assert len(found) == 1
    return found[0]


def texts(rrd: Path, entity: str, component: str = "TextDocument:text") -> list:
    """What a static text said, the last of it last."""
    found = []
    for chunk in RrdReader(rrd).stream():
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and component in batch.schema.names and chunk.is_static:
            found += batch.column(component).to_pylist()
    return found


def shown(rrd: Path, entity: str, component: str, at: np.ndarray) -> list:
    """What the viewer shows at each instant [s]: a component stays as it was sent last."""
    times, values = drawn(rrd, entity, component)
    return [values[i] for i in np.searchsorted(times, np.rint(at * 1e9) / 1e9, side="right") - 1]


@pytest.fixture(scope="module", autouse=True)
def short_pieces() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sink, "PIECE_S", 5)
        yield


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorder:
    directory = tmp_path_factory.mktemp("run")
    with Recorder(directory, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
    return recorder


def test_the_view_made_from_the_record_is_that_of_the_live_run(run, tmp_path):
    again = tmp_path / "again.rrd"
    rrd_from_mcap(run.mcap, again)
    compared = rerun("rrd", "compare", "--unordered", run.rrd, again)
    assert compared.returncode == 0, compared.stdout + compared.stderr


def test_the_comparison_sees_a_different_run(run, tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS - 1)
    assert rerun("rrd", "compare", "--unordered", run.rrd, recorder.rrd).returncode != 0


def test_the_only_time_is_simulated(run):
    timelines = {name for chunk in RrdReader(run.rrd).stream() for name in chunk.timeline_names}
    assert timelines == {"sim_time"}
    assert rerun("rrd", "verify", run.rrd).returncode == 0


def test_the_same_inputs_have_the_same_recording_id_and_another_seed_another(run, tmp_path):
    def identity(rrd: Path) -> str:
        (entry,) = RrdReader(rrd).recordings()
        return entry.recording_id

    again = tmp_path / "again.rrd"
    rrd_from_mcap(run.mcap, again)
    assert identity(again) == identity(run.rrd)
    other = HEADER.__class__(**{**vars(HEADER), "seed": HEADER.seed + 1})
    with Recorder(tmp_path, other, table(), model()) as recorder:
        append_tick(recorder, 0)
    assert identity(recorder.rrd) != identity(run.rrd)


def test_other_results_of_the_same_inputs_are_another_recording_of_the_same_layout(run, tmp_path):
    """As of two builds of the code: in one viewer neither overwrites the other, and both are laid out alike."""
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        append_tick(recorder, 0)
        recorder.append("pose", DT, np.array([3.0, 1e-9, 0.0]), np.array([1.0, 0.0, 0.0, 0.0]))
    (one,), (other,) = (RrdReader(rrd).recordings() for rrd in (run.rrd, recorder.rrd))
    assert one.recording_id != other.recording_id
    assert one.application_id == other.application_id
    fewer = channel_table(THRUSTERS[:4], 2)
    with Recorder(tmp_path, HEADER, fewer, model()) as recorder:
        recorder.append("pose", 0.0, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    (another,) = RrdReader(recorder.rrd).recordings()
    assert another.application_id != one.application_id


def test_the_vehicle_is_where_the_record_says(run):
    times, positions = drawn(run.rrd, "/world/vehicle", "Transform3D:translation")
    _, quaternions = drawn(run.rrd, "/world/vehicle", "Transform3D:quaternion")
    recorded = run.signals["pose.position"]
    assert np.array_equal(times, np.rint(recorded[:, 0] * 1e9) / 1e9)
    np.testing.assert_allclose([p for (p,) in positions], recorded[:, 1:], atol=1e-6)
    w, x, y, z = run.signals["pose.quaternion"][:, 1:].T
    np.testing.assert_allclose([q for (q,) in quaternions], np.stack([x, y, z, w], axis=1), atol=1e-6)


def test_thrust_arrows_are_force_along_the_axis_of_each_thruster(run):
    times, arrows = drawn(run.rrd, "/world/vehicle/thrust", "Arrows3D:vectors")
    colours = shown(run.rrd, "/world/vehicle/thrust", "Arrows3D:colors", times)
    force = run.signals["thrusters.force"][:, 1:]
    compiled = model()
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    axes = np.array([data.site(name).xmat.reshape(3, 3)[:, 2] for name in THRUSTERS])
    expected = force[:, :, None] * axes
    scale = np.sum(np.array(arrows) * expected) / np.sum(expected**2)
    np.testing.assert_allclose(arrows, scale * expected, atol=1e-5)
    # A usual force is drawn 1.6 times as long as the vehicle reaches, to the corners of its hull and its thrusters.
    usual = np.quantile(np.abs(force[: round(5 / DT)]).max(axis=1), 0.95)
    reach = max(np.linalg.norm([0.3, 0.3, 0.3]), np.linalg.norm([0.26, 0.06, 0.36]))
    assert scale == pytest.approx(1.6 * reach / usual)
    signs = {c: np.unique(force[np.array(colours) == c] >= 0) for c in np.unique(colours)}
    assert sorted(bool(s) for (s,) in signs.values()) == [False, True]
    origins = still(run.rrd, "/world/vehicle/thrust", "Arrows3D:origins")
    np.testing.assert_allclose(origins, [data.site(name).xpos for name in THRUSTERS], atol=1e-6)


def test_thrusters_on_what_the_hull_carries_are_drawn_where_they_push(tmp_path):
    header = replace(HEADER, inputs={HEADER.model: POD_MJCF.encode()})
    with Recorder(tmp_path, header, table(), pod_model()) as recorder:
        fly(recorder, 60)
    rrd_from_mcap(recorder.mcap, tmp_path / "again.rrd")
    assert recorder.warnings == ()
    assert thruster_mounts(pod_model()).names == THRUSTERS
    places, axes = places_and_axes(pod_model())
    vehicle = "/world/vehicle"
    for rrd in (recorder.rrd, tmp_path / "again.rrd"):
        np.testing.assert_allclose(still(rrd, f"{vehicle}/thrust", "Arrows3D:origins"), places, atol=1e-6)
        np.testing.assert_allclose(still(rrd, f"{vehicle}/thrusters", "Cylinders3D:centers"), places, atol=1e-6)
        _, arrows = drawn(rrd, f"{vehicle}/thrust", "Arrows3D:vectors")
        expected = recorder.signals["thrusters.force"][:, 1:, None] * axes
        scale = np.sum(np.array(arrows) * expected) / np.sum(expected**2)
        assert scale > 0
        told = "T7: on what moves on the hull, drawn in its reference pose"
        assert still(rrd, "/log/model/moving\\ thrusters", "TextLog:text") == [told]
        np.testing.assert_allclose(arrows, scale * expected, atol=1e-5)


def test_what_cannot_be_drawn_costs_that_part_alone_and_is_told(run, tmp_path):
    """A record of eight thrusters, and a model that has seven."""
    seven = MJCF.replace('site="T8" gear="0 0 1 0 0 0" biastype="user"', 'site="T8" gear="0 0 1 0 0 0"')
    header = replace(HEADER, inputs={HEADER.model: seven.encode()})
    with Recorder(tmp_path, header, table(), mujoco.MjModel.from_xml_string(seven)) as recorder:
        fly(recorder, TICKS)
    reason = "the record has the forces of 8 thrusters, the model has 7"
    (warning,) = recorder.warnings
    assert warning.text == f"run.mcap lets viewers draw less: /scene/thrust is left out: {reason}"
    assert rerun("rrd", "verify", recorder.rrd).returncode == 0
    assert still(recorder.rrd, "/log/model/thrusters", "TextLog:text") == [f"thrusters is not drawn: {reason}"]
    (entities, fewer) = (
        {chunk.entity_path for chunk in RrdReader(rrd).stream() if not chunk.is_static}
        for rrd in (run.rrd, recorder.rrd)
    )
    assert entities - fewer == {"/world/vehicle/thrust"}


def test_a_part_that_fails_is_told_once_and_a_place_that_cannot_be_written_is_not_a_part(tmp_path):
    stream = rr.RecordingStream("parts", send_properties=False)
    stream.save(tmp_path / "parts.rrd")
    parts, tried = Parts(stream, Places()), []

    def fail(error):
        tried.append(error)
        raise error

    parts.draw("/plot/wrench of it", lambda: fail(ValueError("no such\nshape")))
    parts.draw("/plot/wrench of it", lambda: fail(ValueError("again")))
    parts.draw("trail", lambda: tried.append("trail"))
    with pytest.raises(OSError, match="full"):
        parts.draw("target", lambda: fail(OSError("full")))
    sink.finish(stream)
    assert [str(each) for each in tried] == ["no such\nshape", "trail", "full"]
    (place,) = {str(chunk.entity_path) for chunk in RrdReader(tmp_path / "parts.rrd").stream() if chunk.is_static}
    assert place.startswith("/log/model/")
    assert still(tmp_path / "parts.rrd", place, "TextLog:text") == ["/plot/wrench of it is not drawn: no such shape"]


def test_the_current_is_drawn_at_the_vehicle_in_world_axes(run):
    t, current = run.signals["water.current"][:, 0], run.signals["water.current"][:, 1:]
    arrows = shown(run.rrd, "/world/current", "Arrows3D:vectors", t)
    np.testing.assert_allclose([a for (a,) in arrows], CURRENT_M_PER_M_S * current, atol=1e-6)
    _, positions = drawn(run.rrd, "/world/current", "Transform3D:translation")
    np.testing.assert_allclose([p for (p,) in positions], run.signals["pose.position"][:, 1:], atol=1e-6)


def test_what_stays_as_it_is_is_sent_once(tmp_path):
    """Six seconds, two pieces: a current that turns once; a thruster that reverses once, where the pieces join."""
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in range(60):
            t, force = 0.1 * k, np.full(8, 5.0)
            force[2] = 5.0 if k < 50 else -5.0
            recorder.append("thrusters", t, force, force, force)
            current = np.array([0.1, 0.0, 0.0] if k < 25 else [0.0, 0.2, 0.0])
            recorder.append("water", t, current, current)
    times, arrows = drawn(recorder.rrd, "/world/current", "Arrows3D:vectors")
    assert list(times) == [0.0, 2.5]
    np.testing.assert_allclose(
        arrows, [[[0.1 * CURRENT_M_PER_M_S, 0, 0]], [[0, 0.2 * CURRENT_M_PER_M_S, 0]]], atol=1e-6
    )
    times, colours = drawn(recorder.rrd, "/world/vehicle/thrust", "Arrows3D:colors")
    assert list(times) == [0.0, 5.0]
    assert [len(set(each)) for each in colours] == [1, 2]


def test_the_trail_is_one_line_without_gaps_along_the_way_flown(run):
    times, strips = drawn(run.rrd, "/world/trail", "LineStrips3D:strips")
    pieces = np.array([strip for (strip,) in strips])
    assert pieces.shape == (len(times), 2, 3)
    assert np.array_equal(pieces[1:, 0], pieces[:-1, 1])
    assert np.diff(times).max() <= 0.1 + 1e-9
    position = run.signals["pose.position"]
    flown = position[np.searchsorted(position[:, 0], times - 1e-6), 1:]
    np.testing.assert_allclose(pieces[:, 1], flown, atol=1e-6)


def test_the_path_is_drawn_whole_from_the_first_instant(run):
    times, strips = drawn(run.rrd, "/world/path", "LineStrips3D:strips")
    assert list(times) == [0.0]
    np.testing.assert_allclose(strips[0][0], run.signals["path.points"][0, 1:].reshape(-1, 3), atol=1e-5)


@pytest.mark.parametrize(
    ("entity", "signal", "columns"),
    [
        ("/plot/path_error/cross_track", "path_error.cross_track", [0]),
        ("/plot/path_error/along", "path_error.along", [0]),
        ("/plot/attitude/attitude", "path_error.attitude", [0]),
        ("/plot/force/demanded", "wrench.demanded", [0, 1, 2]),
        ("/plot/moment/allocated", "wrench.allocated", [3, 4, 5]),
        ("/plot/thrusters", "thrusters.force", range(8)),
    ],
)
def test_a_curve_is_the_signal_exactly_and_carries_its_unit(run, entity, signal, columns):
    _, scalars = drawn(run.rrd, entity, "Scalars:scalars")
    assert np.array_equal(scalars, run.signals[signal][:, 1:][:, list(columns)])
    names = still(run.rrd, entity, "SeriesLines:names")
    assert len(names) == len(columns)
    assert all(name.endswith("]") for name in names)


@pytest.mark.parametrize("thruster", range(8))
def test_a_lane_changes_when_the_side_of_the_dead_zone_does(run, thruster):
    times, states = drawn(run.rrd, f"/state/{THRUSTERS[thruster]}", "StateChange:state")
    recorded = run.signals["allocation.subset"][:, [0, 1 + thruster]]
    changed = np.concatenate([[True], np.diff(recorded[:, 1]) != 0])
    assert np.array_equal(times, np.rint(recorded[changed, 0] * 1e9) / 1e9)
    assert [int(state) for (state,) in states] == list(recorded[changed, 1])


def test_the_lanes_name_every_state_a_run_can_be_in(run):
    values = still(run.rrd, "/state/allocation", "StateConfiguration:values")
    labels = still(run.rrd, "/state/allocation", "StateConfiguration:labels")
    assert dict(zip(values, labels, strict=True)) == {"0": "exact", "1": "nearest"}
    assert still(run.rrd, "/state/T1", "StateConfiguration:labels") == [
        *("reverse", "off", "forward"),
        *("at lower limit", "at upper limit"),
    ]


def test_health_has_a_lane_for_the_truth_and_one_for_the_belief_of_each_motor(tmp_path):
    """T2 is weakened at 0.2 s and dies at 0.4 s; the controller believes it dead at 0.5 s."""
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in range(6):
            t, true, believed = 0.1 * k, np.ones(8), np.ones(8)
            true[1] = 1.0 if k < 2 else 0.3 if k < 4 else 0.0
            believed[1] = 1.0 if k < 5 else 0.0
            recorder.append("health", t, true, believed, 0.0)
    assert still(recorder.rrd, "/health/T2/true", "StateConfiguration:labels") == ["dead or stuck", "weak", "whole"]
    for entity, expected in (
        ("/health/T1/true", [(0.0, "2")]),
        ("/health/T2/true", [(0.0, "2"), (0.2, "1"), (0.4, "0")]),
        ("/health/T2/believed", [(0.0, "2"), (0.5, "0")]),
    ):
        times, states = drawn(recorder.rrd, entity, "StateChange:state")
        assert [(t, state) for t, (state,) in zip(times, states, strict=True)] == expected


def test_the_way_of_flying_is_a_lane(tmp_path):
    channels = channel_table(THRUSTERS, 2, ("exact",), ("holonomic", "level"))
    with Recorder(tmp_path, HEADER, channels, model()) as recorder:
        for t, code in ((0.0, 0.0), (0.1, 1.0)):
            recorder.append("health", t, np.ones(8), np.ones(8), code)
    times, states = drawn(recorder.rrd, "/state/authority", "StateChange:state")
    assert (list(times), states) == ([0.0, 0.1], [["0"], ["1"]])
    assert still(recorder.rrd, "/state/authority", "StateConfiguration:labels") == ["holonomic", "level"]


def test_a_lane_says_when_a_thruster_is_at_its_limit(tmp_path):
    """T3 is asked for 50 N, its limit, from 0.2 s on; T4 for its lower limit; the belief halves T3's at 0.4 s."""
    limits = np.tile([-40.0, -2.0, 2.0, 50.0], 8)
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in range(6):
            t, force = 0.1 * k, np.zeros(8)
            if k == 0:
                recorder.append("actuation", t, np.zeros(48), limits)
            if k == 4:
                limits[4 * 2 + 3] = 25.0
                recorder.append("actuation", t, np.zeros(48), limits)
            force[2:4] = (10.0 if k < 2 else 50.0 if k < 4 else 24.0), -40.0
            recorder.append("allocation", t, 0.0, 1.0, 0.0, np.sign(force))
            recorder.append("thrusters", t, force, force / 50, force)
    for entity, expected in (
        ("/state/T1", [(0.0, "0")]),
        ("/state/T3", [(0.0, "1"), (0.2, "2"), (0.4, "1")]),
        ("/state/T4", [(0.0, "-2")]),
    ):
        times, states = drawn(recorder.rrd, entity, "StateChange:state")
        assert [(t, state) for t, (state,) in zip(times, states, strict=True)] == expected


def test_a_dead_thruster_is_marked_where_it_sits(tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in range(4):
            true, believed = np.ones(8), np.ones(8)
            true[1], true[2] = (1.0 if k < 1 else 0.0), 0.5
            believed[1] = 1.0 if k < 2 else 0.0
            recorder.append("health", 0.1 * k, true, believed, 0.0)
    times, labels = drawn(recorder.rrd, "/world/vehicle/thrusters", "Cylinders3D:labels")
    _, colours = drawn(recorder.rrd, "/world/vehicle/thrusters", "Cylinders3D:colors")
    assert list(times) == [0.0, 0.1, 0.2]
    assert [each[1] for each in labels] == ["T2", "T2 dead, taken for whole", "T2 dead"]
    assert {each[2] for each in labels} == {"T3 weak, taken for whole"}
    assert {each[0] for each in labels} == {"T1"}
    assert len({each[1] for each in colours}) == 2
    assert colours[0][1] == colours[0][0]
    assert colours[0][2] not in colours[-1][:2]


SCENARIO = """
schema_version: 1
name: told
description: What it is about.
model: model/octa.xml
duration_s: 6.0
path: {type: line, start_m: [0, 0, -3], end_m: [9, 0, -3]}
guidance: {law: path_following, speed_m_s: 0.3}
events:
  - {kind: thrusters, at_s: 2.5, thrusters: [T2], state: weak, efficiency: 0.5}
checks:
  - {kind: signal, signal: path_error.cross_track, statistic: rms, at_most: 0.2, from_s: 1.5}
  - {kind: signal, signal: wrench.demanded, component: 4, statistic: max, at_most: 7.0}
  - {kind: signal, signal: pose.position, statistic: final, at_most: 7.0}
"""


def test_limits_of_checks_and_events_are_lines_in_the_plots_of_what_they_are_about(tmp_path):
    header = HEADER.__class__(**{**vars(HEADER), "resolved": SCENARIO})
    with Recorder(tmp_path, header, table(), model()) as recorder:
        fly(recorder, 20)
    times, values = drawn(recorder.rrd, "/plot/path_error/limit_0", "Scalars:scalars")
    assert (list(times), values) == ([1.5, 6.0], [[0.2], [0.2]])
    assert still(recorder.rrd, "/plot/path_error/limit_0", "SeriesLines:names") == ["limit: rms ≤ 0.2"]
    times, values = drawn(recorder.rrd, "/plot/moment/limit_1", "Scalars:scalars")
    assert (list(times), values) == ([0.0, 6.0], [[7.0], [7.0]])
    entities = {str(chunk.entity_path) for chunk in RrdReader(recorder.rrd).stream()}
    assert not [entity for entity in entities if entity.endswith("limit_2")]
    for plot in ("path_error", "thrusters", "velocity", "height", "heading"):
        times, ((low,), (high,)) = drawn(recorder.rrd, f"/plot/{plot}/event_0", "Scalars:scalars")
        assert times == pytest.approx([2.5, 2.5])
        assert low < high
        names = still(recorder.rrd, f"/plot/{plot}/event_0", "SeriesLines:names")
        assert names == ["2.5 s: T2: weak, 50 % of its force"]
    (text,) = still(recorder.rrd, "/scenario", "TextDocument:text")
    assert "What it is about." in text
    assert "rms of path_error.cross_track ≤ 0.2" in text


def test_heading_and_height_are_what_was_flown(run):
    _, headings = drawn(run.rrd, "/plot/heading/flown", "Scalars:scalars")
    w, z = run.signals["pose.quaternion"][:, 1], run.signals["pose.quaternion"][:, 4]
    np.testing.assert_allclose([h for (h,) in headings], np.degrees(2 * np.arctan2(z, w)), atol=1e-9)
    _, heights = drawn(run.rrd, "/plot/height/vehicle", "Scalars:scalars")
    assert np.array_equal([h for (h,) in heights], run.signals["pose.position"][:, 3])


def test_the_log_is_shown(run):
    times, texts = drawn(run.rrd, "/log", "TextLog:text")
    assert [(t, text) for t, (text,) in zip(times, texts, strict=True)] == [
        (line.t, line.text) for line in read_recording(run.mcap).log
    ]
    assert len(texts) == 4


def test_the_viewer_knows_the_levels_of_the_log(tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for t, level in enumerate(("INFO", "WARNING", "ERROR", "FATAL")):
            recorder.log(float(t), level, "said")
    _, levels = drawn(recorder.rrd, "/log", "TextLog:level")
    assert levels == [["INFO"], ["WARN"], ["ERROR"], ["CRITICAL"]]
    assert [line.level for line in read_recording(recorder.mcap).log] == ["INFO", "WARNING", "ERROR", "FATAL"]


def test_the_file_carries_its_blueprint(run):
    (entry,) = RrdReader(run.rrd).blueprints()
    classes = set()
    for chunk in RrdReader(run.rrd).stream(store=entry):
        batch = chunk.to_record_batch()
        if "ViewBlueprint:class_identifier" in batch.schema.names:
            classes |= {name for (name,) in batch.column("ViewBlueprint:class_identifier").to_pylist()}
    assert classes == {"3D", "TimeSeries", "StateTimeline", "TextLog", "TextDocument"}


def test_the_view_says_how_the_run_ended(tmp_path):
    check = CheckResult("|A f - F|", "FAIL", 0.25, "<=", 0.1, -0.15, 0.2, "so it is", "N, N m")
    end = RunEnd("ended early", "left all bounds", 15, 0.3, "nothing left to steer with", "FAIL", (check,))
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in range(15):
            append_tick(recorder, k)
        recorder.finish(end)
    rrd_from_mcap(recorder.mcap, tmp_path / "again.rrd")
    for rrd in (recorder.rrd, tmp_path / "again.rrd"):
        (said,) = [text for (text,) in texts(rrd, "/scenario")][-1:]
        assert said.startswith("# FAIL\n\nended early, 0.3 s simulated: left all bounds\n\nthe path was given up: ")
        row = r"| **FAIL** | \|A f - F\| | 0.25 must be ≤ 0.1 N, N m | -0.15 | 0.20 s |"
        assert row in said.splitlines()
        assert r"FAIL \|A f - F\|: so it is" in said
    name = texts(recorder.rrd, "/__properties", "RecordingInfo:name")
    assert name[-1][0].startswith("FAIL: run, seed 7, ")


def test_nothing_is_drawn_where_ticks_are_missing(tmp_path):
    ticks = [k for k in range(400) if not 120 <= k < 160 and not 248 <= k < 252]
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        for k in ticks:
            append_tick(recorder, k)
    first, last = DT * 120, DT * 160
    times, values = drawn(recorder.rrd, "/plot/path_error/along", "Scalars:scalars")
    missing = times[np.isnan(np.ravel(values))]
    assert missing == pytest.approx([first, DT * 248])
    times, strips = drawn(recorder.rrd, "/world/trail", "LineStrips3D:strips")
    ends = np.array(strips, float).reshape(len(strips), 2, 3)
    assert not np.any((times > first) & (times < last))
    # No piece is longer than what is flown in two tenths of a second.
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).max() < 0.2
    times, states = drawn(recorder.rrd, "/state/T1", "StateChange:state")
    assert [state for t, (state,) in zip(times, states, strict=True) if t == pytest.approx(first)] == [""]


def test_a_run_without_rows_still_leaves_a_view(tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        recorder.finish(RunEnd("ended early", "at once", 0, 0.0))
    assert rerun("rrd", "verify", recorder.rrd).returncode == 0
    assert len(RrdReader(recorder.rrd).blueprints()) == 1


def test_the_view_can_be_left_out(tmp_path):
    with Recorder(tmp_path, HEADER, table(), model(), view=False) as recorder:
        append_tick(recorder, 0)
    assert recorder.mcap.exists()
    assert not recorder.rrd.exists()


def test_a_record_whose_model_does_not_compile_is_refused(tmp_path):
    header = HEADER.__class__(**{**vars(HEADER), "inputs": {HEADER.model: b"<mujoco><worldbody><body></mujoco>"}})
    with Recorder(tmp_path, header, table(), model(), view=False) as recorder:
        append_tick(recorder, 0)
    with pytest.raises(RecordingError, match="the recorded model does not compile"):
        rrd_from_mcap(recorder.mcap, tmp_path / "run.rrd")


def test_shapes_are_placed_as_the_compiled_model_places_them():
    compiled = model()
    data = mujoco.MjData(compiled)
    data.qpos[:] = [1.0, -2.0, 0.5, 0.5, 0.5, -0.5, 0.5]
    mujoco.mj_kinematics(compiled, data)
    R_WB, p_WB = data.body("octa").xmat.reshape(3, 3), data.body("octa").xpos
    shapes = {shape.name: shape for shape in vehicle_shapes(compiled)}
    assert set(shapes) == {"hull", "tube"}
    for name, shape in shapes.items():
        np.testing.assert_allclose(p_WB + R_WB @ shape.position, data.geom(name).xpos, atol=1e-12)
        np.testing.assert_allclose(R_WB @ shape.rotation, data.geom(name).xmat.reshape(3, 3), atol=1e-12)
    assert [shape.name for shape in world_shapes(compiled)] == ["seabed"]
    assert vehicle_name(compiled) == "octa"
    assert thruster_mounts(compiled).names == THRUSTERS


def test_every_kind_of_geom_is_drawn(tmp_path):
    geoms = """
      <geom name="sphere" type="sphere" size="0.1"/>
      <geom name="ellipsoid" type="ellipsoid" size="0.1 0.2 0.3"/>
      <geom name="cylinder" type="cylinder" size="0.1 0.2" euler="90 0 0"/>
      <geom name="frame" type="mesh" mesh="tetrahedron" pos="0 0 1" rgba="0 1 0 1"/>
    """
    assets = """<asset>
      <hfield name="sand" nrow="2" ncol="2" size="1 1 1 1"/>
      <mesh name="tetrahedron" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
    </asset>"""
    xml = MJCF.replace("<worldbody>", assets + "<worldbody>")
    xml = xml.replace("<body", '<geom name="bed" type="hfield" hfield="sand"/><body')
    xml = xml.replace('<geom name="hull"', geoms + '<geom name="hull"')
    compiled = mujoco.MjModel.from_xml_string(xml)
    with Recorder(tmp_path, HEADER, table(), compiled) as recorder:
        append_tick(recorder, 0)
    body = "/world/vehicle/body"
    assert still(recorder.rrd, f"{body}/ellipsoid", "Ellipsoids3D:half_sizes") == [pytest.approx([0.1, 0.2, 0.3])]
    assert still(recorder.rrd, f"{body}/sphere", "Ellipsoids3D:half_sizes") == [pytest.approx([0.1, 0.1, 0.1])]
    assert still(recorder.rrd, f"{body}/cylinder", "Cylinders3D:lengths") == [pytest.approx(0.4)]
    # A capsule is as long between its ends in the view as in the model, and lies in the same place.
    start = np.array(still(recorder.rrd, f"{body}/tube", "Capsules3D:translations")[0])
    length = still(recorder.rrd, f"{body}/tube", "Capsules3D:lengths")[0]
    assert abs(start[0]) == pytest.approx(0.2)
    assert length == pytest.approx(0.4)
    assert "bed is not drawn" in still(recorder.rrd, "/log/model/bed", "TextLog:text")[0]
    corners = np.array(still(recorder.rrd, f"{body}/frame", "Mesh3D:vertex_positions"))
    wanted = np.array([[0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 2]], dtype=float)
    for corner in wanted:
        assert np.abs(corners - corner).max(axis=1).min() < 1e-6


def test_a_model_without_a_vehicle_is_refused(tmp_path):
    still_life = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    with pytest.raises(RecordingError, match="no free joint"):
        Recorder(tmp_path, HEADER, table(), still_life)


def test_splitting_columns_gives_the_blocks_they_were_recorded_in():
    rows = {
        "fast": np.stack([np.arange(0, 4, 0.1), np.arange(40)], axis=1),
        "slow": np.array([[0.0, 1.0], [2.5, 2.0]]),
    }
    log = (LogLine(2.0, "INFO", "two"), LogLine(7.9, "INFO", "late"))
    batches = list(split_into_batches(rows, log))
    for name, whole in rows.items():
        parts = [batch.rows[name] for batch in batches if name in batch.rows]
        assert np.array_equal(np.concatenate(parts), whole)
    for batch in batches:
        instants = [*(t for part in batch.rows.values() for t in part[:, 0]), *(line.t for line in batch.log)]
        assert len({int(t) for t in instants}) == 1
    assert [line.text for batch in batches for line in batch.log] == ["two", "late"]
    assert list(split_into_batches({}, ())) == []


@pytest.mark.parametrize("seconds", [1, 2, 5])
def test_gathered_pieces_end_at_multiples_of_their_length(seconds):
    class Kept:
        def __init__(self) -> None:
            self.batches: list[Batch] = []
            self.closed = False

        def write(self, batch: Batch) -> None:
            self.batches.append(batch)

        def close(self) -> None:
            self.closed = True

    kept = Kept()
    sink = GatheringSink(kept, seconds)
    rows = np.stack([np.arange(650) * DT, np.arange(650)], axis=1)
    log = tuple(LogLine(t, "INFO", str(t)) for t in (0.5, 6.5, 6.6, 12.9))
    for batch in split_into_batches({"a": rows}, log):
        sink.write(batch)
    sink.close()
    assert kept.closed
    assert np.array_equal(np.concatenate([batch.rows["a"] for batch in kept.batches]), rows)
    assert tuple(line for batch in kept.batches for line in batch.log) == log
    pieces = [np.unique(batch.rows["a"][:, 0] // seconds) for batch in kept.batches]
    assert [len(piece) for piece in pieces] == [1] * len(pieces)
    assert len(np.unique(pieces)) == len(pieces)
