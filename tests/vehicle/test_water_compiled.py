"""The same laws once: what runs inside MuJoCo equals the readable Python it was compiled from."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support import plain_callbacks
from support.places import CUBE
from support.vehicles import vehicle
from support.water_bodies import DENSITY, GRAVITY, coriolis_matrix, random_body, scene, set_state, tumbling

import cube_sim
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle import faults
from cube_sim.vehicle.laws import current, hydrodynamics, thrust_law


def tuples(*arrays):
    return [tuple(float(x) for x in array) for array in arrays]


def equal(fast, plain) -> None:
    fast, plain = np.array(fast, dtype=float), np.array(plain, dtype=float)
    np.testing.assert_allclose(fast, plain, rtol=0.0, atol=1e-12 * max(np.abs(plain).max(), 1.0))


def test_nothing_in_the_plain_modules_is_compiled():
    laws = "vehicle.laws.hydrodynamics", "vehicle.laws.current", "vehicle.laws.thrust_law"
    for name in ("tuples", *laws, "vehicle.plugin.inertia", "vehicle.plugin.callbacks"):
        module = plain_callbacks.plain(f"cube_sim.{name}")
        functions = [f for f in vars(module).values() if hasattr(f, "__code__")]
        assert len(functions) > 1
        assert not any(hasattr(f, "py_func") for f in functions)
    assert not any(hasattr(f, "native_name") for f in plain_callbacks.callbacks().values())


@pytest.mark.parametrize("seed", range(10))
def test_water_wrench_is_the_uncompiled_law(seed):
    rng = np.random.default_rng(seed)
    body, state = random_body(rng, 3.0), tumbling(rng)
    R = rotation_from_quaternion(state[3:7])
    nu, v_c, buoyancy, cb = tuples(state[7:], body.current, [0.0, 0.0, DENSITY * body.volume * GRAVITY], body.cb)
    arguments = body.added, body.linear, body.quadratic, R, nu, v_c, buoyancy, cb
    plain = plain_callbacks.plain("cube_sim.vehicle.laws.hydrodynamics").water_wrench(*arguments)
    assert all(isinstance(x, float) for x in plain)
    equal(hydrodynamics.water_wrench(*arguments), plain)


@pytest.mark.parametrize("seed", range(5))
def test_coriolis_is_fossens_matrix(seed):
    rng = np.random.default_rng(seed)
    body, nu = random_body(rng), rng.normal(size=6)
    expected = coriolis_matrix(body.added, nu) @ nu
    np.testing.assert_allclose(hydrodynamics.coriolis(body.added, tuple(nu)), expected, atol=1e-13)
    assert abs(np.dot(expected, nu)) < 1e-12  # it does no work


def test_the_current_is_the_uncompiled_law():
    rng = np.random.default_rng(1)
    plain = plain_callbacks.plain("cube_sim.vehicle.laws.current")
    times, heights, v = np.array([0.0, 1.0, 2.5]), np.array([-9.0, -1.0]), rng.normal(size=(6, 3))
    for t, z in rng.uniform([-1.0, -11.0], [4.0, 1.0], (100, 2)).tolist():
        arguments = t, z, times, heights, v, (0.1, -0.2, 0.3), 0.05
        for fast, expected in zip(current.current_at(*arguments), plain.current_at(*arguments), strict=True):
            equal(fast, expected)
    body, R = random_body(rng), rotation_from_quaternion(tumbling(rng)[3:7])
    arguments = body.added, 12.0, (0.1, -0.2, 0.3), R, (0.3, 0.2, -0.1)
    equal(current.accelerating_water(*arguments), plain.accelerating_water(*arguments))


def test_thrust_is_the_uncompiled_law_and_numpys():
    plain = plain_callbacks.plain("cube_sim.vehicle.laws.thrust_law")
    curve = vehicle("cube").thrusters.characteristics[0]
    for c in np.linspace(-1.2, 1.2, 241).tolist():
        arguments = c, *curve.command_dead_zone, curve.commands, curve.forces
        equal(thrust_law.force_of_command(*arguments), plain.force_of_command(*arguments))
        assert plain.force_of_command(*arguments) == pytest.approx(float(curve.force(c)), abs=1e-12)
    rng = np.random.default_rng(0)
    for n in (2, 3, 22):
        x, y = np.cumsum(rng.uniform(0.1, 1.0, n)), rng.normal(size=n)
        for at in [*rng.uniform(x[0] - 1.0, x[-1] + 1.0, 200), *x]:
            equal(thrust_law.interpolate(at, x, y), plain.interpolate(at, x, y))
            assert plain.interpolate(at, x, y) == pytest.approx(np.interp(at, x, y), abs=1e-12)


def pull(time, position, rotation, velocity, through_water):
    return 3.0 - position[0], time, rotation[0, 1], velocity[4], through_water[0], 0.1


def two_hulls(solver: str = "Newton") -> mujoco.MjModel:
    """Two random hulls, one with a jointed arm and armature, a table current, a force, contact under PGS."""
    rng = np.random.default_rng(7)
    first, second = random_body(rng), replace(random_body(rng), current=(0.0, 0.0, 0.0))
    arm = '<body pos="0.2 0 0"><joint axis="0 1 0" armature="0.1"/><geom size="0.1" mass="1.5"/></body>'
    xml = scene([(first, "a", (0, 0, 0)), (second, "b", (1.5, 0, 0))], current=(0.1, 0.2, 0.0), inside=arm)
    xml = xml.replace("<worldbody>", '<worldbody><geom type="plane" size="9 9 1" pos="0 0 -0.2"/>')
    spec = mujoco.MjSpec.from_string(xml.replace("<option", f'<option solver="{solver}"'))
    spec.joint("a").armature = 0.3
    rows = [[t, z, *rng.normal(size=3)] for t in (0.0, 0.4) for z in (-3.0, 3.0)]
    return cube_sim.load_model(spec, {"water:current": np.ravel(rows)}, {"b": pull})


@pytest.mark.parametrize("solver", ["Newton", "PGS"])
def test_the_passive_callback_is_its_own_source_run_by_the_interpreter(solver):
    """Mass matrix, its factor, passive forces and accelerations of MuJoCo with either, over random states."""
    model = two_hulls(solver)
    compiled, interpreted = mujoco.MjData(model), mujoco.MjData(model)
    before = mujoco.get_mjcb_passive()
    source = plain_callbacks.callbacks()["passive"]
    for seed in range(6):
        for data in (compiled, interpreted):
            set_state(data, tumbling(np.random.default_rng(seed)))
            data.qvel[6:] = np.random.default_rng(100 + seed).normal(size=model.nv - 6)
            data.time = 0.1 * seed
        mujoco.mj_forward(model, compiled)
        try:
            mujoco.set_mjcb_passive(lambda m, d: source(m._address, d._address))
            mujoco.mj_forward(model, interpreted)
        finally:
            mujoco.set_mjcb_passive(before)
        for name in ("M", "qLD", "qfrc_passive", "qacc"):
            equal(getattr(compiled, name), getattr(interpreted, name))
        assert np.abs(compiled.qfrc_passive).max() > 1.0
        mujoco.set_mjcb_passive(lambda m, d: None)  # and without either, MuJoCo has other numbers
        mujoco.mj_forward(model, interpreted)
        mujoco.set_mjcb_passive(before)
        assert np.abs(compiled.M - interpreted.M).max() > 0.1


def test_the_thrust_callback_is_its_own_source_run_by_the_interpreter():
    model = cube_sim.load_model(CUBE)
    faults.set_efficiency(model, "T2", 0.4)
    faults.set_stuck(model, "T3", -7.0)
    faults.set_supply(model, "T4", 0.8)
    data = mujoco.MjData(model)
    source = plain_callbacks.callbacks()["thrust"]
    for seed in range(20):
        data.act[:] = np.random.default_rng(seed).uniform(-1.1, 1.1, 8)
        mujoco.mj_forward(model, data)
        equal(data.actuator_force, [source(model._address, data._address, i) for i in range(8)])
