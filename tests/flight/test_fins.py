"""A vehicle that its fins steer flies scenarios: both loops the same, what is recorded, what wrong knowledge costs."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.finned import x_tail
from support.places import SCENARIOS

import cube_sim
from cube_sim.control.authority import Authority
from cube_sim.control.balanced_attitude import ROLL_OF_FINS
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight

LINE, HELIX, CIRCLE, SINUSOID = (
    SCENARIOS / f"remus100_{name}.yaml" for name in ("line", "helix", "circle", "sinusoid")
)
SHORT = {"duration_s": 4, "checks": [{"kind": "allowed_forces"}]}
ACROSS = {"current_m_s": [0.0, 0.3, 0.0]}
SETTLED = [{"kind": "signal", "signal": "path_error.cross_track", "statistic": "rms", "from_s": 80, "at_most": 1}]


@pytest.mark.parametrize(
    ("path", "changes"),
    [
        (HELIX, ACROSS),
        (HELIX, {"navigation": {}}),
        (HELIX, {"allocation.method": "pseudo_inverse"}),
        (CIRCLE, {}),
        (SINUSOID, {}),
    ],
    ids=["across", "navigated", "baseline", "circle", "sinusoid"],
)
def test_both_loops_fly_the_same(path, changes, monkeypatch):
    assert assert_same_flight(path, {**SHORT, **changes}, monkeypatch) > 0.9


def test_what_the_fins_are_asked_for_is_what_they_come_to():
    flight = Flight(LINE, SHORT)
    flight.fly(200)
    signals = flight.signals
    wanted, had = signals["fins.deflection_wanted"][:, 1:], signals["fins.deflection"][:, 1:]
    period, lag, rate = 0.02, 0.1, 0.5
    expected = had[:-1] + np.clip((wanted[:-1] - had[:-1]) * -np.expm1(-period / lag), -rate * period, rate * period)
    np.testing.assert_allclose(had[1:], expected, atol=2e-3 * rate)
    assert np.abs(wanted).max() <= np.radians(13.6) + 1e-9
    assert np.all(np.abs(wanted - had) <= rate * (lag + period) + 1e-12)
    made, total = signals["fins.wrench"][:, 1:], signals["wrench.allocated"][:, 1:]
    thrusters = signals["thrusters.force_demanded"][:, 1:] * [1.0, 0.0, 0.0, -0.543 / 3.86, 0.0, 0.0]
    np.testing.assert_allclose(made + thrusters, total, atol=1e-12)


def test_a_snapshot_flies_on_the_same():
    one = Flight(LINE, SHORT)
    one.fly(60)
    kept = one.snapshot()
    one.fly(60)
    first = one.signals["fins.deflection"][-60:].tobytes()
    one.restore(kept)
    one.fly(60)
    assert one.signals["fins.deflection"][-60:].tobytes() == first


def test_too_slow_for_its_fins_it_is_told_before_it_flies(tmp_path):
    run = cube_sim.run(LINE, {**SHORT, "guidance.speed_m_s": 0.3}, out=tmp_path)
    told = [line.text for line in run.log if line.level == "WARNING" and line.t == 0.0]
    assert any("path will not be followed" in text and "than thrusters and fins have" in text for text in told)


def test_other_fins_are_no_knowledge_of_these(tmp_path):
    with pytest.raises(ScenarioError, match="has the thrusters"):
        Flight(LINE, {"knowledge.model": str(SCENARIOS.parent / "models" / "torpedo.xml")})


@pytest.mark.flight
@pytest.mark.parametrize("key", ["drag", "fins", "thrust"])
@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_it_flies_with_wrong_knowledge(key, factor, tmp_path):
    changes = {**ACROSS, f"knowledge.{key}": factor, "duration_s": 120, "checks": SETTLED}
    error = cube_sim.run(LINE, changes, out=tmp_path).checks[0].value
    assert error is not None
    assert error < 0.05


@pytest.mark.flight
@pytest.mark.parametrize("heading", [0.0, 180.0])
def test_it_gathers_way_from_rest_wherever_its_nose_points(heading, tmp_path):
    """Without way on its fins make nothing: it goes on ahead, turns in a wide bow, and joins its line."""
    start = {"initial.velocity_m_s": [0.0, 0.0, 0.0], "initial.attitude_deg": [0.0, 0.0, heading]}
    wide = {"control.safe_mode.distance_limit_m": None, "duration_s": 120, "checks": [{**SETTLED[0], "from_s": 110}]}
    run = cube_sim.run(LINE, {**start, **wide}, out=tmp_path)
    error, ahead = run.checks[0].value, run.signals["velocity.linear"][:, 1]
    assert error is not None
    assert error < 0.05
    assert ahead.min() > -0.01


def drawn(tmp_path, **how) -> dict:
    """A scenario's changes that fly a drawn torpedo along a line, from 1 m beside it, in a current across."""
    model = tmp_path / "drawn.xml"
    model.write_text(x_tail(**how))
    return {
        "model": str(model),
        "parameters": {},
        "duration_s": 100,
        "initial": {"position_m": [0.0, 1.0, -20.0], "velocity_m_s": [0.8, 0.0, 0.0]},
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [500.0, 0.0, -20.0]},
        "guidance.speed_m_s": 0.8,
        "current_m_s": [0.0, 0.2, 0.0],
        "checks": [{**SETTLED[0], "from_s": 70}],
    }


@pytest.mark.flight
@pytest.mark.parametrize(
    ("how", "authority"),
    [({}, "LINE"), ({"bow_planes": True}, "PLANE"), ({"side_thrusters": True}, "HOLONOMIC")],
    ids=["x_tail", "bow_planes", "side_thrusters"],
)
def test_drawn_torpedoes_with_an_x_tail_keep_a_line(how, authority, tmp_path, monkeypatch):
    """Fins that stall; bow planes push up without a moment; beside side thrusters fins leave what they cannot make."""
    changes = drawn(tmp_path, **how)
    run = cube_sim.run(LINE, changes, out=tmp_path / "out")
    error = run.checks[0].value
    assert error is not None
    assert error < 0.002
    assert Authority(int(run.signals["health.authority"][-1, 1])).name == authority
    assert np.abs(run.signals["fins.deflection"][:, 1:]).max() <= 0.35 + 1e-9
    assert assert_same_flight(LINE, {**changes, "duration_s": 2, "checks": SHORT["checks"]}, monkeypatch) > 0.9


@pytest.mark.flight
def test_beside_side_thrusters_fins_come_first(tmp_path):
    """Under way the fins take off the thrusters what turns the hull aslant to its flow."""
    changes = drawn(tmp_path, side_thrusters=True)
    turned = cube_sim.run(LINE, changes, out=tmp_path / "turned")
    (tmp_path / "drawn.xml").write_text(x_tail(side_thrusters=True).replace("-0.35 0.35", "-1e-6 1e-6"))
    fixed = cube_sim.run(LINE, changes, out=tmp_path / "fixed")
    pushed = [np.abs(run.signals["thrusters.force"][-500:, 2:]).sum(axis=1).mean() for run in (turned, fixed)]
    assert pushed[0] < 0.95 * pushed[1]


@pytest.mark.flight
def test_a_hull_that_only_rights_itself_is_not_asked_to_roll_over(tmp_path):
    """Asked to roll far, to point what an unknown current takes, its heading would be judged in axes turned by that."""
    changes = drawn(tmp_path, makes_roll=False) | {
        "duration_s": 20,
        "initial": {"position_m": [0.0, 1.5, -20.0], "velocity_m_s": [1.0, 0.4, 0.0]},
        "guidance.speed_m_s": 1.2,
        "current_m_s": [0.0, 0.4, 0.0],
        "checks": SHORT["checks"],
    }
    run = cube_sim.run(LINE, changes, out=tmp_path / "out")
    w, x, y, z = run.signals["reference.quaternion"][:, 1:].T
    assert np.abs(2.0 * (y * z + w * x)).max() < 1.1 * ROLL_OF_FINS


@pytest.mark.flight
def test_fins_leave_a_place_to_thrusters_that_hold_it(tmp_path):
    """Pushed ahead to keep the way on that only fins need, such a hull left its point for good."""
    changes = drawn(tmp_path, side_thrusters=True, makes_roll=False) | {
        "duration_s": 60,
        "initial": {"position_m": [9.5, 0.3, -20.0]},
        "path": {"type": "point", "position_m": [10.0, 0.0, -20.0]},
        "current_m_s": [0.0, 0.0, 0.0],
        "checks": [{**SETTLED[0], "statistic": "max", "from_s": 40}],
    }
    run = cube_sim.run(LINE, changes, out=tmp_path / "out")
    error = run.checks[0].value
    assert error is not None
    assert error < 0.01
    assert Authority(int(run.signals["health.authority"][-1, 1])) is Authority.TRIM


def test_a_wrench_from_outside_is_shared_with_the_fins_and_commands_leave_them_amidships():
    flight = Flight(LINE, SHORT)
    for _ in range(3):
        flight.step(wrench=[2.0, -1.0, 0.0, -0.28, 0.0, 0.638])
    assert abs(flight.signals["fins.deflection_wanted"][-1, 2]) > 0.01
    made = flight.signals["wrench.allocated"][-1, 1:]
    np.testing.assert_allclose(made, [2.0, -1.0, 0.0, -0.28, 0.0, 0.638], atol=0.02)
    flight.step(commands=[0.5])
    assert not flight.signals["fins.deflection_wanted"][-1, 1:].any()
    assert not flight.signals["fins.wrench"][-1, 1:].any()
