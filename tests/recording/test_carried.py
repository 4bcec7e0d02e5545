"""Bodies that move on a hull in the Rerun view, against MuJoCo's own kinematics."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation
from support.hanging import hanging
from support.water_bodies import values

import cube_sim
from cube_sim.recording.carried_bodies import carried_bodies, positions_at_rest, whole_reach
from cube_sim.recording.export import rrd_from_mcap
from cube_sim.recording.reading import read_recording
from cube_sim.recording.rerun.carried import CarriedDrawing
from cube_sim.recording.rerun.parts import Parts
from cube_sim.recording.rerun.places import Places
from cube_sim.vehicle.carried_joints import carried_joints


def _random_model(rng):
    """A hull with two branches: bodies of one to three joints with anchors, references and bodies welded between."""

    def place():
        return f'pos="{values(rng.normal(size=3))}" quat="{values(rng.normal(size=4))}"'

    def joint(kind):
        at = f'pos="{values(rng.normal(size=3))}"'
        more = "" if kind == "ball" else f' axis="{values(rng.normal(size=3))}" ref="{rng.normal()!r}"'
        return f'<joint type="{kind}" {at}{more}/>'

    def body(depth):
        several = (
            ("hinge",),
            ("slide",),
            ("ball",),
            ("hinge", "hinge"),
            ("slide", "slide", "hinge"),
            ("slide", "ball"),
        )
        joints = "".join(joint(kind) for kind in several[rng.integers(len(several))])
        inside = body(depth - 1) if depth else ""
        return f'<body {place()}>{joints}<geom size="0.1"/><body {place()}><geom size="0.1"/>{inside}</body></body>'

    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><worldbody><body><joint type="hinge"/><geom size="1"/></body>'
        f'<body name="hull"><freejoint/><geom size="1"/>{body(2)}<body {place()}>{body(1)}</body></body>'
        "</worldbody></mujoco>"
    )


@pytest.mark.parametrize("seed", range(6))
def test_bodies_stand_where_mujoco_has_them(seed):
    rng = np.random.default_rng(seed)
    model = _random_model(rng)
    data, bodies, joints = mujoco.MjData(model), carried_bodies(model, "hull"), carried_joints(model, 2)
    assert joints is not None
    assert model.qpos0[joints.places.positions] == pytest.approx(positions_at_rest(model, "hull")[0], abs=0)
    rows = rng.normal(size=(5, model.nq))
    for qpos in rows:
        qpos[1:4], qpos[4:8] = 0.0, (1, 0, 0, 0)
    there = {2: np.tile(np.eye(4), (5, 1, 1))}
    for each in bodies:
        p, q = each.pose(rows[:, joints.places.positions])
        step = np.tile(np.eye(4), (5, 1, 1))
        step[:, :3, 3], step[:, :3, :3] = p, Rotation.from_quat(q, scalar_first=True).as_matrix()
        there[each.body] = there[each.parent] @ step
    for k, qpos in enumerate(rows):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        for each in bodies:
            assert there[each.body][k, :3, 3] == pytest.approx(data.xpos[each.body], abs=1e-12)
            assert there[each.body][k, :3, :3] == pytest.approx(data.xmat[each.body].reshape(3, 3), abs=1e-12)


def _transforms(rrd, entity):
    """Times [s], translations and rotations of an entity."""
    found = []
    for chunk in RrdReader(rrd).stream():
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and "Transform3D:translation" in batch.schema.names and not chunk.is_static:
            t = batch.column("sim_time").cast("int64").to_numpy() / 1e9
            parts = [batch.column(f"Transform3D:{what}").to_pylist() for what in ("translation", "quaternion")]
            found += zip(t, *parts, strict=True)
    found.sort(key=lambda row: row[0])
    t, p, q = zip(*found, strict=True)
    return np.array(t), np.array(p)[:, 0], Rotation.from_quat(np.array(q)[:, 0])


@pytest.mark.parametrize("seed", range(6))
def test_no_joint_brings_anything_out_of_reach(seed):
    """Slides at their reference: what a slide without a range may do, nobody knows."""
    rng = np.random.default_rng(seed)
    model = _random_model(rng)
    data, hull, farthest = mujoco.MjData(model), model.body("hull").id, 0.0
    of_hull = model.body_rootid[model.geom_bodyid] == hull
    for _ in range(200):
        for joint in np.flatnonzero(model.body_rootid[model.jnt_bodyid] == hull).tolist():
            at, kind = int(model.jnt_qposadr[joint]), model.jnt_type[joint]
            if kind == mujoco.mjtJoint.mjJNT_HINGE:
                data.qpos[at] = rng.uniform(-np.pi, np.pi)
            elif kind == mujoco.mjtJoint.mjJNT_BALL:
                data.qpos[at : at + 4] = Rotation.random(random_state=rng).as_quat()
        mujoco.mj_kinematics(model, data)
        away = np.linalg.norm(data.geom_xpos[of_hull] - data.xpos[hull], axis=1)
        farthest = max(farthest, float((away + model.geom_size[of_hull, 0]).max()))
    assert farthest <= whole_reach(model, "hull")


def test_an_arm_that_is_folded_is_in_reach_stretched():
    text = """<mujoco><compiler angle="radian"/><worldbody><body name="hull"><freejoint/><geom size="0.2"/>
      <body pos="0.25 0 0"><joint axis="0 1 0"/><geom type="box" size="0.2 0.01 0.01" pos="0.2 0 0"/>
      <body pos="0.4 0 0" euler="0 3.14159265 0"><joint axis="0 1 0"/>
      <geom type="box" size="0.14 0.01 0.01" pos="0.14 0 0"/>
      <body><joint type="slide" axis="1 0 0" limited="true" range="-0.1 0.3"/>
      <geom type="box" size="0.01 0.01 0.01"/></body></body></body></body></worldbody></mujoco>"""
    stretched = 0.25 + 0.4 + 0.3 + np.linalg.norm([0.01] * 3)
    assert whole_reach(mujoco.MjModel.from_xml_string(text)) == pytest.approx(stretched)


def test_a_run_and_a_fleet_show_what_hangs_on_the_hull(tmp_path):
    own = hanging(tmp_path, duration_s=2)
    together = {key: own.pop(key) for key in ("schema_version", "name", "model", "duration_s", "surface_m")}
    checks = own.pop("checks")
    (tmp_path / "alone.yaml").write_text(json.dumps({**together, **own, "checks": checks}))
    other = {**own, "initial": {"position_m": [0, 5, -5]}}
    other["path"] = {**own["path"], "start_m": [0, 5, -5], "end_m": [20, 5, -5]}
    own["checks"] = checks
    (tmp_path / "pair.yaml").write_text(json.dumps({**together, "vehicles": {"one": own, "other": other}}))
    for name, prefix, world in (("alone", "", "/world"), ("pair", "one/", None)):
        cube_sim.run(tmp_path / f"{name}.yaml", out=tmp_path / name)
        again = tmp_path / f"{name}.rrd"
        rrd_from_mcap(tmp_path / name / "run.mcap", again)
        entities = {chunk.entity_path for chunk in RrdReader(again).stream()}
        lamps = sorted(each for each in entities if each.endswith("/carried/pendulum/carried/lamp"))
        assert len(lamps) == (1 if name == "alone" else 2), entities
        lamp = lamps[0]
        assert world is None or lamp == f"{world}/vehicle/carried/pendulum/carried/lamp"
        signals = read_recording(tmp_path / name / "run.mcap").signals
        rows = signals[f"{prefix}joints.position"]
        model = mujoco.MjModel.from_xml_path(str(tmp_path / "ballasted.xml"))
        data, pendulum = mujoco.MjData(model), lamp.removesuffix("/carried/lamp")
        for rrd in (tmp_path / name / "run.rrd", again):
            (t, p, q), (_, at, turned) = (_transforms(rrd, entity) for entity in (pendulum, lamp))
            assert t == pytest.approx(rows[:, 0], abs=1e-9)
            ends = p + q.apply(at)
            assert np.ptp(ends, axis=0).max() > 1e-3
            for k in range(0, len(t), 10):
                data.qpos[:3], data.qpos[7:] = 0.0, rows[k, 1:]
                mujoco.mj_kinematics(model, data)
                assert ends[k] == pytest.approx(data.body("lamp").xpos, abs=1e-6)
                assert (q[k] * turned[k]).as_matrix() == pytest.approx(data.body("lamp").xmat.reshape(3, 3), abs=1e-6)


def test_of_a_record_without_joints_they_stand_in_the_reference_pose(tmp_path):
    model = _random_model(np.random.default_rng(0))
    stream = rr.RecordingStream("still", recording_id="still", send_properties=False)
    stream.save(tmp_path / "still.rrd")
    places = Places()
    drawing = CarriedDrawing(stream, model, "hull", places, Parts(stream, places), recorded=False)
    stream.flush()
    stream.disconnect()
    still = {
        chunk.entity_path: chunk.to_record_batch().column("Transform3D:translation").to_pylist()[0][0]
        for chunk in RrdReader(tmp_path / "still.rrd").stream()
        if "Transform3D:translation" in chunk.to_record_batch().schema.names and chunk.is_static
    }
    placed = {path for path, _ in drawing.placed(positions_at_rest(model, "hull"))}
    assert still.keys() == placed
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    first = carried_bodies(model, "hull")[0]
    there = data.xmat[2].reshape(3, 3).T @ (data.xpos[first.body] - data.xpos[2])
    assert still[f"/world/vehicle/carried/{first.name}"] == pytest.approx(there, abs=1e-6)
    with pytest.raises(ValueError, match="positions of joints, the model has"):
        list(drawing.placed(np.zeros((1, 1))))
