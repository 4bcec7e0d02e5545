"""The whole loop: what a run leaves behind, that it is repeatable, and what happens when it goes wrong."""

import ast
import json
import re
import shlex
import shutil
import subprocess
import sys

import mujoco
import numpy as np
import pytest
from support.flights import FORCES_ONLY, thruster_event, values
from support.places import CUBE, HELIX, MODELS, REPO, SCENARIOS

import cube_sim
from cube_sim.control.path_follower import PathFollower
from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.flight import loop
from cube_sim.recording.reading import read_recording
from cube_sim.scenario import load
from cube_sim.scenario.document import parse_value
from cube_sim.verdict import EarlyEnd


def parse_settings(line: str) -> dict[str, object]:
    words = iter(shlex.split(line, comments=True))
    pairs = [next(words).partition("=") for option in words if option == "--set"]
    return {path: parse_value(value) for path, _, value in pairs}


SHORT = {"duration_s": 3.0, "checks": FORCES_ONLY}
THROWN = {
    **SHORT,
    "physics.integrator": "Euler",
    "initial.velocity_m_s": [320.0, 0.0, 0.0],
}


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    return cube_sim.run(HELIX, SHORT, tmp_path_factory.mktemp("short"))


@pytest.mark.flight
def test_a_run_leaves_its_four_files_and_the_same_in_memory(short):
    assert sorted(p.name for p in short.directory.iterdir()) == [
        "resolved.yaml",
        "run.mcap",
        "run.rrd",
        "verdict.json",
    ]
    written = json.loads((short.directory / "verdict.json").read_text())
    assert written["verdict"] == short.verdict == "PASS"
    assert set(written) == {
        "verdict", "checks", "simulated_s", "ended_early", "log", "real_time_factor", "versions",
    }  # fmt: skip
    assert written["simulated_s"] == short.simulated_s == 3.0
    assert written["ended_early"] is short.ended_early is None
    assert {"name", "verdict", "value", "relation", "limit", "margin", "at_s"} <= set(written["checks"][0])
    assert set(written["versions"]) >= {"mujoco", "numpy", "proxsuite", "cube-sim"}


@pytest.mark.flight
@pytest.mark.parametrize("record", ["mcap", "none"])
def test_less_may_be_recorded_of_the_same_flight(record, short, tmp_path):
    run = cube_sim.run(HELIX, SHORT, tmp_path / "run", record=record)
    left = {"resolved.yaml", "verdict.json"} | ({"run.mcap"} if record == "mcap" else set())
    assert {file.name for file in run.directory.iterdir()} == left
    assert run.checks == short.checks
    for name, rows in short.signals.items():
        assert run.signals[name].tobytes() == rows.tobytes(), name
    if record == "mcap":
        assert (run.directory / "run.mcap").read_bytes() == (short.directory / "run.mcap").read_bytes()


@pytest.mark.flight
def test_every_channel_has_a_row_per_tick_from_start_to_end(short):
    t = short.signals["pose.position"][:, 0]
    np.testing.assert_allclose(t, 0.02 * np.arange(151), atol=1e-12)
    for name, rows in short.signals.items():
        assert np.all(np.isfinite(rows)), name
        if not name.startswith(("actuation.", "path.")):
            np.testing.assert_array_equal(rows[:, 0], t, err_msg=name)


@pytest.mark.flight
def test_the_recorded_numbers_hang_together(short):
    s = values(short)
    A = s["actuation.matrix"][0].reshape(6, -1)
    np.testing.assert_allclose(s["thrusters.force_demanded"] @ A.T, s["wrench.allocated"], atol=1e-9)
    from cube_sim.spatial import rotation_from_quaternion

    for k in range(0, 151, 10):
        R_WF = rotation_from_quaternion(s["target.quaternion"][k])
        e = R_WF.T @ (s["pose.position"][k] - s["target.position"][k])
        np.testing.assert_allclose(e, [*s["path_error.along"][k], *s["path_error.lateral"][k]], atol=1e-9)


@pytest.mark.flight
def test_the_velocity_is_the_derivative_of_the_pose(short):
    s = values(short)
    from cube_sim.spatial import rotation_from_quaternion

    for k in range(10, 140, 10):
        slope = (s["pose.position"][k + 1] - s["pose.position"][k - 1]) / 0.04
        R = rotation_from_quaternion(s["pose.quaternion"][k])
        np.testing.assert_allclose(R @ s["velocity.linear"][k], slope, atol=2e-3)


@pytest.mark.flight
def test_the_produced_forces_follow_the_commands_through_lag_and_characteristic(short):
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE, {"hull:thruster_dead_zone": (-2.0, 2.0)}))
    s = values(short)
    activation = np.zeros(8)
    for k in range(150):
        np.testing.assert_allclose(vehicle.thrusters.force(activation), s["thrusters.force"][k], atol=1e-5)
        c = s["thrusters.command"][k]
        activation = c + (activation - c) * np.exp(-0.02 / 0.02)
        # RK4 integrates the 20 ms lag in two steps of 10 ms: its own growth factor, not the exact exponential
        z = -0.5
        rk4 = (1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) ** 2
        activation = c + (activation - c) * rk4 / np.exp(-1.0)


@pytest.mark.flight
def test_the_same_scenario_gives_the_same_bytes_in_another_process(short, tmp_path):
    code = "import sys, json, cube_sim\ncube_sim.run(sys.argv[1], json.loads(sys.argv[2]), sys.argv[3])\n"
    subprocess.run(
        [sys.executable, "-c", code, str(HELIX), json.dumps(SHORT), str(tmp_path / "again")], check=True, cwd=tmp_path
    )
    assert (tmp_path / "again" / "run.mcap").read_bytes() == (short.directory / "run.mcap").read_bytes()


def test_a_step_too_long_for_the_motors_is_refused(tmp_path):
    """The lag of 20 ms under a step that the scenario, not the model, sets."""
    steps = {**SHORT, "physics.step_s": 0.06, "control_period_s": 0.06}
    with pytest.raises(ScenarioError, match=r"physics.step_s.*T1: its lag of 0.02 s is unstable under RK4"):
        cube_sim.run(HELIX, steps, tmp_path / "out")


@pytest.mark.flight
def test_a_state_that_leaves_the_real_numbers_ends_the_run_as_error_with_the_last_good_state(tmp_path):
    """An Euler step of 10 ms on a hull thrown at 320 m/s: its drag overshoots and the state blows up."""
    result = cube_sim.run(HELIX, {**THROWN, "duration_s": 20.0}, tmp_path / "out")
    assert result.verdict == "ERROR"
    assert json.loads((tmp_path / "out" / "verdict.json").read_text())["verdict"] == "ERROR"
    pose = result.signals["pose.position"]
    assert 0.0 < pose[-1, 0] < 20.0
    assert np.all(np.isfinite(pose))
    assert result.ended_early.time_s == result.simulated_s == pytest.approx(pose[-1, 0] + 0.02)
    assert re.match(r"the \w+ of 'hull' is ", result.ended_early.reason)
    last = result.log[-1]
    assert (last.t, last.level) == (result.simulated_s, "ERROR")
    assert last.text == f"{result.ended_early.reason}: the run ends here"
    written = json.loads((tmp_path / "out" / "verdict.json").read_text())
    reason = result.ended_early.reason
    assert written["ended_early"] == {"time_s": result.simulated_s, "reason": reason, "verdict": "ERROR"}
    assert written["simulated_s"] == result.simulated_s


@pytest.mark.flight
def test_what_mujoco_warns_of_is_said_at_the_tick_that_met_it(tmp_path):
    """Ten steps a tick: the state has left MuJoCo's bounds, too, before anybody looks."""
    result = cube_sim.run(HELIX, {**THROWN, "control_period_s": 0.1, "duration_s": 1.0}, tmp_path / "out")
    *warnings, error = result.log
    assert {line.t for line in result.log} == {result.simulated_s} == {0.1}
    assert error.level == "ERROR"
    assert any(line.text.startswith("MuJoCo: Nan, Inf or huge value in Q") for line in warnings)


@pytest.mark.flight
def test_a_last_step_that_leaves_the_real_numbers_is_an_error_too(tmp_path):
    """All rows but the last are there, and no check would miss it."""
    whole = cube_sim.run(HELIX, {**THROWN, "duration_s": 20.0}, tmp_path / "whole").signals["pose.position"]
    result = cube_sim.run(HELIX, {**THROWN, "duration_s": round(whole[-1, 0] + 0.02, 6)}, tmp_path / "out")
    assert len(result.signals["pose.position"]) == len(whole)
    assert result.verdict == "ERROR"


def test_a_run_and_its_files_move_together(tmp_path):
    """A checkout with its logs is carried elsewhere, and its resolved scenario still finds the model."""
    first, second = tmp_path / "here", tmp_path / "there"
    (first / "scenarios").mkdir(parents=True)
    shutil.copytree(MODELS, first / "models")
    shutil.copy(HELIX, first / "scenarios")
    cube_sim.run(first / "scenarios" / HELIX.name, {**SHORT, "duration_s": 0.1}, first / "logs" / "a")
    assert "\nmodel: ../../models/cube.xml\n" in (first / "logs" / "a" / "resolved.yaml").read_text()
    first.rename(second)
    assert load(second / "logs" / "a" / "resolved.yaml").scenario.model == str(second / "models" / "cube.xml")


def test_bad_input_writes_nothing(tmp_path):
    with pytest.raises(ScenarioError, match="duration_s"):
        cube_sim.run(HELIX, {"duration_s": -1.0}, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_folder_with_something_else_in_it_is_left_alone(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(RecordingError, match=r"thesis\.tex"):
        cube_sim.run(HELIX, SHORT, tmp_path)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_a_dead_zone_beyond_the_thrusters_reach_is_a_mistake_at_its_place(tmp_path):
    text = HELIX.read_text().replace("dead_zone_N: [-2.0, 2.0]", "dead_zone_N: [-60.0, 2.0]")
    text = text.replace("../models/", f"{REPO}/models/")
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(ScenarioError, match=r"x\.yaml:\d+:\d+: thrusters\.dead_zone_N: .*out of order"):
        cube_sim.run(tmp_path / "x.yaml", None, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_model_without_water_is_a_mistake_at_its_place(tmp_path):
    (tmp_path / "dry.xml").write_text(
        "<mujoco><worldbody><body name='b'><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    text = HELIX.read_text().replace("../models/cube.xml", "dry.xml")
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(ScenarioError, match=r"x\.yaml:\d+:\d+: model: .*no hull to put into the water"):
        cube_sim.run(tmp_path / "x.yaml", None, tmp_path / "out")


def test_a_check_of_a_signal_nobody_records_is_a_mistake_before_the_run(tmp_path):
    text = (
        HELIX.read_text()
        .replace("../models/", f"{REPO}/models/")
        .replace("path_error.cross_track", "path_error.crosstrack")
    )
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(
        ScenarioError, match=r"x\.yaml:\d+:\d+: checks\.0\.signal: .*did you mean path_error\.cross_track"
    ):
        cube_sim.run(tmp_path / "x.yaml", None, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.fixture
def two_hulls(tmp_path):
    """The CUBE and a passive drum beside it, which comes first."""
    spec = mujoco.MjSpec.from_file(str(CUBE))
    drum = spec.worldbody.add_body(name="drum", pos=[0.0, 30.0, -5.0])
    drum.add_freejoint()
    drum.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.3, 0, 0], mass=20.0)
    numbers = {"volume": [0.02], "centre_of_buoyancy": [0.0] * 3}
    for name in ("added_mass", "linear_damping", "quadratic_damping"):
        numbers[name] = [10.0, 10.0, 10.0, 1.0, 1.0, 1.0]
    for name, data in numbers.items():
        spec.add_numeric(name=f"drum:{name}", data=data, size=len(data))
    (tmp_path / "two.xml").write_text(spec.to_xml())
    path = tmp_path / "two.yaml"
    path.write_text(HELIX.read_text().replace("../models/cube.xml", "two.xml"))
    return path


@pytest.mark.flight
def test_a_model_with_several_hulls_is_flown_by_the_one_named(two_hulls, tmp_path):
    short = {**SHORT, "duration_s": 0.2}
    with pytest.raises(ScenarioError, match=r"two\.yaml:\d+:8: model: the model has several hulls: .*hull.*drum"):
        cube_sim.run(two_hulls, short, tmp_path / "out")
    with pytest.raises(ScenarioError, match=r"override vehicle: no hull 'hul'; the model has .*drum"):
        cube_sim.run(two_hulls, {**short, "vehicle": "hul"}, tmp_path / "out")
    with pytest.raises(ScenarioError, match=r"override vehicle: .*'drum' has no thruster"):
        cube_sim.run(two_hulls, {**short, "vehicle": "drum"}, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    run = cube_sim.run(two_hulls, {**short, "vehicle": "hull"}, tmp_path / "out")
    alone = cube_sim.run(HELIX, short, tmp_path / "alone")
    assert read_recording(tmp_path / "out" / "run.mcap").vehicle == "hull"
    np.testing.assert_allclose(run.signals["pose.position"], alone.signals["pose.position"], atol=1e-9)


README = (REPO / "README.md").read_text()
SETTINGS = [
    parse_settings(line)
    for line in re.findall(r"^cube-sim run scenarios/cube_helix\.yaml (--set .*)$", README, re.MULTILINE)
]
CALLS = [
    ast.literal_eval(text) for text in re.findall(r'cube_sim\.run\("scenarios/cube_helix\.yaml", (\{.*?\})[,)]', README)
]


def test_an_event_after_the_end_names_the_override_that_put_the_end_there(tmp_path):
    path = SCENARIOS / "cube_lose_one.yaml"
    overrides = {"duration_s": 20, "checks": FORCES_ONLY}
    with pytest.raises(ScenarioError, match=r"events\.0\.at_s: 40 s is not before the end .* \(override duration_s\)$"):
        cube_sim.run(path, overrides, tmp_path / "out")


def test_the_readme_has_examples():
    assert SETTINGS
    assert CALLS


@pytest.mark.flight
@pytest.mark.parametrize("overrides", SETTINGS + [call for call in CALLS if call not in SETTINGS], ids=str)
def test_the_examples_of_the_readme_pass(overrides, tmp_path):
    assert cube_sim.run(HELIX, overrides, tmp_path / "out").verdict == "PASS"


@pytest.mark.flight
def test_a_controller_without_an_answer_ends_the_run_as_error_with_the_last_good_state(tmp_path, monkeypatch):
    """Whatever made it so: thrusters at rest and a vehicle adrift are no result to judge."""
    decide, ticks = PathFollower.decide, []

    def until_one_second(self, state, applied, dt, force_ratio):
        ticks.append(dt)
        decision = decide(self, state, applied, dt, force_ratio)
        return decision if sum(ticks) < 1.0 else decision._replace(wrench=np.full(6, np.nan))

    monkeypatch.setattr(PathFollower, "decide", until_one_second)
    monkeypatch.setattr(loop, "begin_ticks", lambda *_: None)  # compiled code asks nobody
    run = cube_sim.run(HELIX, SHORT, tmp_path / "run")
    assert run.verdict == "ERROR"
    assert all(np.isfinite(rows).all() for name, rows in run.signals.items() if name != "path.points")
    (line,) = (line for line in read_recording(tmp_path / "run" / "run.mcap").log if line.level == "ERROR")
    assert line.text == "the controller's answer is not a number: the run ends here"
    assert run.ended_early == EarlyEnd(run.simulated_s, "the controller's answer is not a number")
    assert run.simulated_s == pytest.approx(0.98)


@pytest.mark.flight
def test_a_run_has_its_warnings_at_hand(tmp_path):
    """All that the recording has at the level WARNING or above, and nothing else."""
    events = [thruster_event(0.5, ["T1", "T2"]), {"kind": "current", "at_s": 1.0, "current_m_s": [0.1, 0, 0]}]
    settings = {**SHORT, "duration_s": 1.5, "control.faults": "told", "events": events}
    run = cube_sim.run(HELIX, settings, tmp_path / "run")
    recorded = read_recording(tmp_path / "run" / "run.mcap").log
    assert {line.level for line in recorded} == {"INFO", "WARNING"}
    assert list(run.log) == [line for line in recorded if line.level != "INFO"]
    assert [(line.t, line.text) for line in run.log if "dead;" not in line.text] == [
        (0.5, "T1, T2: dead"),
        (1.0, "the current is now [0.1, 0.0, 0.0] m/s"),
    ]
    written = json.loads((tmp_path / "run" / "verdict.json").read_text())["log"]
    assert [(entry["time_s"], entry["text"]) for entry in written] == [(line.t, line.text) for line in run.log]


@pytest.mark.flight
def test_a_fault_told_at_the_very_start_can_be_judged(tmp_path):
    dead = thruster_event(0, ["T1"])
    run = cube_sim.run(HELIX, {**SHORT, "control.faults": "told", "events": [dead]}, tmp_path / "run")
    assert run.verdict == "PASS"
    assert not run.signals["thrusters.force"][:, 1].any()
