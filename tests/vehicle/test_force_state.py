"""An own force that sees commands and activations, and one that keeps a state."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.both_loops import assert_same_flight
from support.edited_cube import edited_text
from support.flights import FORCES_ONLY
from support.places import HELIX
from support.water_bodies import DENSITY, Body

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.flight import Flight
from cube_sim.scenario import load
from cube_sim.vehicle.plugin import user_forces

STIFFNESS, DAMPER = 40.0, 12.0
WINCH = 'name="winch" site="eye" dyntype="filter" dynprm="0.5" gainprm="0" gear="1 0 0 0 0 0"'
MOTOR = f"<actuator><general {WINCH}/></actuator>"


def maxwell(time, position, rotation, velocity, through_water, command, activation, state=(0.0,)):
    """A spring whose other end a damper holds: its force is forgotten with DAMPER / STIFFNESS; along the world's x."""
    f = rotation.T @ np.array([-STIFFNESS * (position[0] - state[0]), 0.0, 0.0])
    return (f[0], f[1], f[2], 0.0, 0.0, 0.0), (STIFFNESS / DAMPER * (position[0] - state[0]),)


def oscillator(time, position, rotation, velocity, through_water, command, activation, state=(0.0, 0.0)):
    """A mass on a spring that the hull does not feel, but for its force; driven by x."""
    pull = STIFFNESS * (position[0] - state[0])
    f = rotation.T @ np.array([-pull, 0.0, 0.0])
    return (f[0], f[1], f[2], 0.0, 0.0, 0.0), (state[1], pull / 3.0 - 0.2 * state[1])


def awkward_oscillator(time, position, rotation, velocity, through_water, command, activation, state=(0.0, 0.0)):
    """The same, in a way numba cannot compile."""
    named = {"x": position[0], "rank": lambda: 3}
    wrench, rates = oscillator(time, position, rotation, velocity, through_water, command, activation, state)
    return [*wrench[: named["rank"]()], 0.0, 0.0, 0.0], list(rates)


def winch(time, position, rotation, velocity, through_water, command, activation):
    return 3.0 * command[0], 5.0 * activation[0], 0.0, 0.0, 0.0, 0.0


def floating() -> Body:
    return Body(mass=10.0, volume=10.0 / DENSITY, added=np.diag([15.0] * 3 + [0.5] * 3), inertia_at_cg=np.eye(3))


def spec(timestep=0.01, extra=""):
    return floating().spec(timestep=timestep, inside='<site name="eye"/>', extra=extra)


def rate_maxwell(t, y):
    x, v, s = y
    return [v, -STIFFNESS * (x - s) / 25.0, STIFFNESS / DAMPER * (x - s)]


def rate_oscillator(t, y):
    x, v, s, w = y
    pull = STIFFNESS * (x - s)
    return [v, -pull / 25.0, w, pull / 3.0 - 0.2 * w]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("function", "rate", "compiled"),
    [
        (maxwell, rate_maxwell, True),
        (oscillator, rate_oscillator, True),
        (awkward_oscillator, rate_oscillator, False),
    ],
)
def test_the_state_is_integrated_with_the_motion(function, rate, compiled):
    """Against the same differential equations apart, in any attitude."""
    model = cube_sim.load_model(spec(), forces={"hull": function})
    assert user_forces.is_compiled(function) is compiled
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3, 0.0, 0.0, 0.5, -0.5, 0.5, 0.5
    mujoco.mj_step(model, data, nstep=300)
    start = np.concatenate([[0.3, 0.0], np.zeros(model.na)])
    expected = solve_ivp(rate, (0.0, 3.0), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    np.testing.assert_allclose([data.qpos[0], data.qvel[0], *data.act], expected, atol=1e-6)
    assert np.abs(data.act).min() > 1e-3
    assert [model.actuator(i).name for i in range(model.nu)] == ["hull:force_state"]


def test_it_sees_commands_and_activations_of_the_moment():
    model = cube_sim.load_model(spec(extra=MOTOR), forces={"hull": winch})
    data = mujoco.MjData(model)
    data.ctrl[0], data.act[0] = 2.0, 0.7
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qacc[:3], [6.0 / 25.0, 3.5 / 25.0, 0.0], rtol=1e-12)
    data.ctrl[0] = -1.0
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(-3.0 / 25.0)


def test_the_state_comes_behind_all_other_activations():
    model = cube_sim.load_model(spec(extra=MOTOR), forces={"hull": oscillator})
    data = mujoco.MjData(model)
    data.qpos[0], data.ctrl[0] = 0.3, 1.0
    mujoco.mj_step(model, data, nstep=50)
    assert data.act[0] == pytest.approx(1.0 - np.exp(-1.0), abs=1e-6)  # the winch's lag
    assert model.actuator("hull:force_state").actadr == 1
    assert data.act.size == 3
    assert data.act[1] > 0.01


def test_other_parameters_leave_it_its_state():
    model = cube_sim.load_model(spec(extra=MOTOR), forces={"hull": oscillator})
    data = mujoco.MjData(model)
    data.qpos[0] = 0.3
    cube_sim.set_parameters(model, {"hull:added_mass": np.diag([5.0] * 3 + [0.5] * 3)})
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(-STIFFNESS * 0.3 / 15.0)
    np.testing.assert_allclose(data.act_dot[1:], [0.0, STIFFNESS * 0.3 / 3.0])


def test_forces_of_before_keep_their_arguments_whatever_their_names():
    def with_a_constant(t, p, R, v, u, k=2.0):
        return k, 0.0, 0.0, 0.0, 0.0, 0.0

    model = cube_sim.load_model(spec(), forces={"hull": with_a_constant})
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(2.0 / 25.0)
    assert model.nu == 0


def without_activation(time, position, rotation, velocity, through_water, command):
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


def without_length(time, position, rotation, velocity, through_water, command, activation, state):
    return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), state


def begun_elsewhere(time, position, rotation, velocity, through_water, command, activation, state=(1.0,)):
    return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), state


def too_many_rates(time, position, rotation, velocity, through_water, command, activation, state=(0.0,)):
    return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0)


def no_rates(time, position, rotation, velocity, through_water, command, activation, state=(0.0,)):
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@pytest.mark.parametrize(
    ("function", "told"),
    [
        (without_activation, r"takes command after the motion; command, activation, and state=\(0.0, ...\) are right"),
        (without_length, r"state=\(0.0, 0.0\) says that it keeps two numbers"),
        (begun_elsewhere, "which begin at 0"),
        (too_many_rates, r"returns rates of shape \(2,\); its state has 1"),
        (no_rates, "fails for the hull at rest where it starts: ValueError"),
    ],
)
def test_what_makes_no_sense_is_refused(function, told):
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(spec(), forces={"hull": function})


def changes(tmp_path, function) -> dict:
    """Of a scenario that flies a CUBE with that force."""
    text = f'<text name="hull:force" data="{__name__}:{function.__name__}"/></custom>'
    (tmp_path / "model.xml").write_text(edited_text(("</custom>", text)))
    return {"model": str(tmp_path / "model.xml"), "duration_s": 3.0, "checks": FORCES_ONLY}


@pytest.mark.flight
@pytest.mark.parametrize("function", [maxwell, winch])
def test_both_loops_fly_it_to_the_same_bits(function, tmp_path, monkeypatch):
    """The loop in Python gives commands before it steps; so must the compiled one, which has forward's results."""
    assert assert_same_flight(load(HELIX, changes(tmp_path, function)), None, monkeypatch) > 0.5


@pytest.mark.flight
def test_a_snapshot_and_many_flights_keep_the_state(tmp_path):
    scenario = load(HELIX, changes(tmp_path, maxwell))
    one = Flight(scenario)
    for _ in range(50):
        one.step()
    kept = one.snapshot()
    ends = []
    for _ in range(2):
        one.restore(kept)
        for _ in range(50):
            one.step()
        ends.append([*one.mission.data.qpos, *one.mission.data.act])
    assert ends[0] == ends[1]
    assert abs(one.mission.data.act[-1]) > 0.01
    alone = cube_sim.run(HELIX, changes(tmp_path, maxwell), tmp_path / "out")
    many = cube_sim.fly_many(HELIX, [changes(tmp_path, maxwell)] * 2, threads=2, signals=["pose.position"])
    for flight in many:
        np.testing.assert_array_equal(flight.signals["pose.position"], alone.signals["pose.position"])
