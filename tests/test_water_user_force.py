"""A user's own force: one Python function, compiled when it can be."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from mujoco import rollout
from water_bodies import DENSITY, Body, flown, get_state, random_body, reference, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle import user_forces

STIFFNESS = 30.0


def spring(time, position, rotation, velocity, through_water):
    """A spring to the world's origin, tied at the body's; plain arithmetic on arrays."""
    f = rotation.T @ (-STIFFNESS * position)
    return f[0], f[1], f[2], 0.0, 0.0, 0.0


def awkward_spring(time, position, rotation, velocity, through_water):
    """The same, in a way numba cannot compile."""
    named = {"x": position[0], "y": position[1], "z": position[2], "rank": lambda: 1}
    f = rotation.T @ np.array([-STIFFNESS * named[k] for k in "xyz"])
    return [*f, *np.zeros(3 * named["rank"]())]


def swell(time, position, rotation, velocity, through_water):
    return 5.0 * math.sin(2.0 * time), 0.0, 0.0, 0.0, 0.0, 0.1 * math.cos(time)


def floating() -> Body:
    return Body(mass=10.0, volume=10.0 / DENSITY, added=np.diag([15.0] * 3 + [0.5] * 3), inertia_at_cg=np.eye(3))


@pytest.mark.parametrize(("function", "compiled"), [(spring, True), (awkward_spring, False)])
def test_mass_on_a_spring(function, compiled):
    """(m + a) x'' = -k x in any attitude: x(t) = x0 cos(sqrt(k / (m + a)) t)."""
    model = cube_sim.load_model(floating().spec(timestep=0.01), forces={"hull": function})
    assert user_forces.is_compiled(function) is compiled
    q = np.array([0.5, -0.5, 0.5, 0.5])
    start = np.concatenate([[0.3, -0.2, 0.1], q, np.zeros(6)])
    end = flown(model, start, 4.0)
    np.testing.assert_allclose(end[:3], start[:3] * np.cos(np.sqrt(STIFFNESS / 25.0) * 4.0), atol=1e-7)


def test_it_is_a_force_in_body_axes_at_the_right_time():
    rng = np.random.default_rng(0)
    body, start = random_body(rng), tumbling(rng)
    model = cube_sim.load_model(body.spec(timestep=0.005), forces={"hull": swell})
    import scipy.integrate
    from water_bodies import fossen

    solution = scipy.integrate.solve_ivp(
        lambda t, y: fossen(body, y, np.array(swell(t, None, None, None, None))),
        (0.0, 1.5),
        start,
        method="DOP853",
        rtol=1e-11,
        atol=1e-12,
    )
    np.testing.assert_allclose(flown(model, start, 1.5), solution.y[:, -1], atol=1e-6)
    assert np.abs(solution.y[:3, -1] - reference(body, start, 1.5)[:3]).max() > 0.05


def test_velocity_arrives_in_body_axes():
    seen = []

    def spy(time, position, rotation, velocity, through_water):
        seen.append((time, position, rotation, velocity, through_water))
        return np.zeros(6)

    rng = np.random.default_rng(1)
    current = np.array([0.3, -0.2, 0.1])
    model = cube_sim.load_model(floating().spec("Euler"), forces={"hull": spy})
    model.opt.wind[:] = current
    data = mujoco.MjData(model)
    set_state(data, tumbling(rng))
    data.time = 3.5
    mujoco.mj_forward(model, data)
    time, position, rotation, velocity, through_water = seen[-1]
    assert time == 3.5
    np.testing.assert_allclose(position, data.qpos[:3])
    np.testing.assert_allclose(rotation, data.xmat[1].reshape(3, 3))
    np.testing.assert_allclose(velocity, get_state(data)[7:])
    np.testing.assert_allclose(velocity[:3] - through_water[:3], rotation.T @ current, atol=1e-14)
    np.testing.assert_allclose(velocity[3:], through_water[3:])


def test_named_in_the_model_file():
    text = '<custom><text name="hull:force" data="test_water_user_force:spring"/></custom>'
    model = floating().model(timestep=0.01, extra=text)
    end = flown(model, np.array([0.4, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), 2.0)
    assert end[0] == pytest.approx(0.4 * np.cos(np.sqrt(STIFFNESS / 25.0) * 2.0), abs=1e-7)


def test_compiled_forces_run_on_threads():
    model = cube_sim.load_model(floating().spec(), forces={"hull": spring})
    data = mujoco.MjData(model)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    initial = np.zeros((4, mujoco.mj_stateSize(model, full)))
    for k in range(4):
        set_state(data, tumbling(np.random.default_rng(k)))
        mujoco.mj_getState(model, data, initial[k], full)
    once, _ = rollout.rollout(model, [data], initial, nstep=50)
    twice, _ = rollout.rollout(model, [mujoco.MjData(model), mujoco.MjData(model)], initial, nstep=50)
    assert np.array_equal(once, twice)


def test_the_model_in_another_process_says_that_the_function_is_missing(tmp_path):
    """A saved model carries no code: there its force is not a number, never silently nothing."""
    model = cube_sim.load_model(floating().spec(), forces={"hull": spring})
    from cube_sim.vehicle import packing

    packing.numbers(model)[packing.PROCESS] = 0.123
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.isnan(data.qacc).all()


@pytest.mark.parametrize(
    ("forces", "reason"),
    [
        ({"ship": spring}, "no hull 'ship'; the model has hull"),
        ({"hull": lambda t, p, R, v, u: (1.0, 2.0)}, "returns shape (2,); six values are right"),
        ({"hull": lambda t, p: p}, "fails at rest at the origin: TypeError"),
    ],
)
def test_wrong_functions_are_refused(forces, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(floating().spec(), forces=forces)
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ("spring", "write package.module:function"),
        ("no_such_module:f", "cannot be found"),
        ("math:tether", "cannot be found"),
    ],
)
def test_wrong_names_are_refused(data, reason):
    with pytest.raises(ModelError, match=reason):
        floating().model(extra=f'<custom><text name="hull:force" data="{data}"/></custom>')
