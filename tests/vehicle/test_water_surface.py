"""A hull at the water's surface: draught, stiffness, energy, and its motion integrated a second time."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.places import MODELS, REPO
from support.plain_callbacks import callbacks
from support.water_bodies import DENSITY, GRAVITY, Body, flown, random_body, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.mission.planar_identification import identify_planar_model
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion

HALF_AXES = np.array([0.8, 0.25, 0.15])
VOLUME = 4.0 / 3.0 * pi * float(HALF_AXES.prod())
DEEP = -5.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


def at_surface(body: Body, half_axes=HALF_AXES, surface=0.0, **options) -> mujoco.MjModel:
    return cube_sim.load_model(body.spec(**options), {"water:surface": surface, "hull:surface_half_axes": half_axes})


def ellipsoid(share: float, **changes) -> Body:
    """A uniform ellipsoid that weighs a share of the water it displaces; its water takes energy only slowly."""
    mass = float(share * DENSITY * VOLUME)
    moments = 0.2 * mass * ((HALF_AXES**2).sum() - HALF_AXES**2)
    body = Body(
        mass=mass,
        inertia_at_cg=np.diag(moments),
        volume=VOLUME,
        added=np.diag([0.1 * mass, 0.8 * mass, 1.1 * mass, *(0.5 * moments)]),
    )
    return replace(body, **changes)


def vertical_moments(depth: float, w: float) -> tuple[float, float]:
    """Share of an ellipsoid under water, and the mean of depth over its volume, 0 above: sums over slices.

    Args:
        depth: of its centre [m].
        w: its half extent along the vertical [m].
    """
    t = np.clip(depth / w, -1.0, 1.0)
    s = 0.5 * (t + 1.0) * NODES - 0.5 * (1.0 - t)
    slices = 0.75 * (1.0 - s**2) * WEIGHTS * 0.5 * (t + 1.0)
    return float(slices.sum()), float((slices * (depth - w * s)).sum())


def water_energy(body: Body, half_axes, position, R) -> float:
    """Potential energy of weight and displaced water [J]; the latter falls as the hull rises."""
    up = R[2]
    depth = -position[2] - up @ body.cb
    mean_depth = vertical_moments(depth, np.linalg.norm(half_axes * up))[1]
    return body.mass * GRAVITY * (position[2] + up @ body.cg) + DENSITY * body.volume * GRAVITY * mean_depth


def energy(body: Body, half_axes, state) -> float:
    R, nu = rotation_from_quaternion(state[3:7]), state[7:]
    share = vertical_moments(-state[2] - R[2] @ body.cb, np.linalg.norm(half_axes * R[2]))[0]
    return 0.5 * nu @ (body.rigid + share * body.added) @ nu + water_energy(body, half_axes, state[:3], R)


def wrench_at(model: mujoco.MjModel, position, angles) -> np.ndarray:
    """Force and moment [N, N m] of weight and water on a hull at rest, in body axes at its origin."""
    data = mujoco.MjData(model)
    data.qpos[:7] = [*position, *quaternion_from_euler(*angles)]
    mujoco.mj_forward(model, data)
    R = data.xmat[1].reshape(3, 3)
    force = data.qfrc_passive - data.qfrc_bias
    return np.concatenate([R.T @ force[:3], force[3:]])


def test_a_sphere_floats_at_its_draught():
    """S(t) = (2 + 3 t - t^3)/4 = the weight's share, the classical cubic of a floating sphere."""
    radius, share = 0.2, 0.3
    volume = 4.0 / 3.0 * pi * radius**3
    body = Body(mass=share * DENSITY * volume, volume=volume, linear=np.diag([20.0] * 3 + [1.0] * 3))
    model = cube_sim.load_model(body.spec(), {"water:surface": 0.0})  # without geoms it is a sphere of its volume
    end = flown(model, np.array([0.0, 0.0, -2.0, 1.0, *np.zeros(9)]), 120.0)
    submerged = brentq(lambda h: pi * h**2 * (3.0 * radius - h) / 3.0 - share * volume, 0.0, 2.0 * radius)
    assert end[2] == pytest.approx(radius - submerged, abs=1e-9)
    assert np.abs(end[7:]).max() < 1e-9


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_an_ellipsoid_s_draught_and_stiffness(share):
    """Heave rho g A_w; roll and pitch rho g (I_w - V_sub z_B), with the area and moments of the waterline's ellipse."""
    body = ellipsoid(share)
    model = at_surface(body)
    a, b, c = HALF_AXES
    t = brentq(lambda t: (2.0 + 3.0 * t - t**3) / 4.0 - share, -1.0, 1.0)
    z = -t * c
    np.testing.assert_allclose(wrench_at(model, (0.0, 0.0, z), (0.0, 0.0, 0.0)), np.zeros(6), atol=1e-9)
    shrunk = np.sqrt(1.0 - t**2)
    area, under = pi * a * b * shrunk**2, share * VOLUME
    z_B = -0.75 * c * (1.0 - t) ** 2 / (2.0 - t)  # above the centre of mass
    h = 1e-5
    heave = [wrench_at(model, (0.0, 0.0, z + dz), (0.0, 0.0, 0.0))[2] for dz in (-h, h)]
    assert (heave[0] - heave[1]) / (2.0 * h) == pytest.approx(DENSITY * GRAVITY * area, rel=1e-8)
    for axis, second in ((0, pi / 4.0 * a * b**3 * shrunk**4), (1, pi / 4.0 * a**3 * b * shrunk**4)):
        tilt = np.zeros(3)
        tilt[axis] = h
        righting = (wrench_at(model, (0.0, 0.0, z), -tilt) - wrench_at(model, (0.0, 0.0, z), tilt))[3 + axis] / (2 * h)
        assert righting == pytest.approx(DENSITY * GRAVITY * (second + under * z_B), rel=1e-8)


def test_the_water_s_wrench_is_the_derivative_of_its_energy():
    rng = np.random.default_rng(3)
    body = replace(random_body(rng), current=(0.0, 0.0, 0.0))
    half_axes = np.array([0.3, 0.2, 0.1])
    model, data = at_surface(body, half_axes), mujoco.MjData(at_surface(body, half_axes))
    for _ in range(20):
        q, z, h = rng.normal(size=4), rng.uniform(-0.25, 0.25), 1e-6
        data.qpos[:7] = [0.3, -0.2, z, *(q / np.linalg.norm(q))]
        data.qvel[:] = 0.0
        mujoco.mj_forward(model, data)
        start = data.qpos.copy()
        for axis in range(6):
            energies = []
            for step in (-h, h):
                moved, along = start.copy(), np.zeros(6)
                along[axis] = 1.0
                mujoco.mj_integratePos(model, moved, along, step)
                energies.append(water_energy(body, half_axes, moved[:3], rotation_from_quaternion(moved[3:7])))
            slope = (energies[1] - energies[0]) / (2.0 * h)
            assert data.qfrc_passive[axis] - data.qfrc_bias[axis] == pytest.approx(-slope, abs=2e-6)


def test_bobbing_and_tumbling_without_drag_keep_their_energy():
    """Added mass fades as well: without the terms that come of it the energy drifts by a percent of what moves."""
    rng = np.random.default_rng(5)
    for _ in range(3):
        body, half_axes = random_body(rng).ideal(), np.array([0.3, 0.2, 0.12])
        start = tumbling(rng)
        start[2] = -0.1
        before = energy(body, half_axes, start)
        moving = abs(0.5 * start[7:] @ (body.rigid + body.added) @ start[7:])
        # S has a kink in its slope where the hull comes out: a crossing costs the integrator an order
        for step, lost in ((2e-3, 2e-6), (2.5e-4, 1.5e-7)):
            end = flown(at_surface(body, half_axes, timestep=step), start, 4.0)
            assert abs(energy(body, half_axes, end) - before) < lost * moving


def test_drag_brings_a_hull_to_rest_at_the_surface():
    rng = np.random.default_rng(7)
    body, half_axes = replace(random_body(rng), volume=0.02, current=(0.0, 0.0, 0.0)), np.array([0.3, 0.2, 0.12])
    model = at_surface(body, half_axes)
    state = tumbling(rng)
    state[2] = -1.0
    last = energy(body, half_axes, state)
    for _ in range(40):
        state = flown(model, state, 1.0)
        now = energy(body, half_axes, state)
        assert now < last + 1e-7 * abs(last)
        last = now
    assert np.abs(flown(model, state, 300.0)[7:]).max() < 1e-5
    assert state[2] > -0.3


def lagrange(body: Body, half_axes) -> callable:
    """Motion in the plane across x of [y, z, roll] by Lagrange's equations, energies differentiated numerically."""

    def mass(q):
        s, c = np.sin(q[2]), np.cos(q[2])
        B = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # [v, w, p] of [y', z', roll']
        pick = np.ix_([1, 2, 3], [1, 2, 3])
        up = np.array([0.0, s, c])
        share = vertical_moments(-q[1] - up @ body.cb, np.linalg.norm(half_axes * up))[0]
        return B.T @ (body.rigid[pick] + share * body.added[pick]) @ B

    def potential(q):
        R = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(q[2]), -np.sin(q[2])], [0.0, np.sin(q[2]), np.cos(q[2])]])
        return water_energy(body, half_axes, np.array([0.0, q[0], q[1]]), R)

    def rates(_, y):
        q, v, h = y[:3], y[3:], 1e-5
        steps = h * np.eye(3)
        dM = [(mass(q + e) - mass(q - e)) / (2.0 * h) for e in steps]
        dU = np.array([(potential(q + e) - potential(q - e)) / (2.0 * h) for e in steps])
        M_rate = sum(v[i] * dM[i] for i in range(3))
        force = np.array([0.5 * v @ dM[i] @ v for i in range(3)]) - M_rate @ v - dU
        return [*v, *np.linalg.solve(mass(q), force)]

    return rates


def test_bobbing_and_rolling_as_lagrange_has_it():
    body = ellipsoid(0.6, cg=np.array([0.0, 0.02, -0.03]), cb=np.array([0.0, 0.0, 0.01]))
    model = at_surface(body, timestep=1e-3)
    start = np.array([0.0, 0.0, -0.1, *quaternion_from_euler(0.5, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    R = rotation_from_quaternion(start[3:7])
    velocity = np.array([0.0, 0.2, 0.4])
    start[7:10], start[10] = R.T @ velocity, 0.3
    y = solve_ivp(
        lagrange(body, HALF_AXES), (0.0, 5.0), [0.0, -0.1, 0.5, 0.2, 0.4, 0.3], method="DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]
    end = flown(model, start, 5.0)
    R = rotation_from_quaternion(end[3:7])
    roll = np.arctan2(R[2, 1], R[2, 2])
    np.testing.assert_allclose([end[1], end[2], roll], y[:3], atol=1e-6)
    np.testing.assert_allclose([*(R @ end[7:10])[1:], end[10]], y[3:], atol=1e-5)


def test_a_hull_deeper_than_its_reach_moves_as_in_endless_water():
    rng = np.random.default_rng(11)
    body = random_body(rng)
    start = tumbling(rng)
    start[2] = DEEP
    assert np.array_equal(flown(at_surface(body), start, 2.0), flown(body.model(), start, 2.0))


def test_a_hull_under_a_raised_surface_moves_as_under_one_at_zero():
    rng = np.random.default_rng(13)
    body, start, up = random_body(rng), tumbling(rng), np.zeros(13)
    start[2], up[2] = -0.05, 7.0
    low, high = flown(at_surface(body), start, 1.0), flown(at_surface(body, surface=7.0), start + up, 1.0)
    np.testing.assert_allclose(high - up, low, atol=1e-10)


def test_above_the_water_it_falls_as_in_air():
    body = random_body(np.random.default_rng(17))
    start = np.array([0.0, 0.0, 10.0, 1.0, *np.zeros(9)])
    end = flown(at_surface(replace(body, cg=np.zeros(3))), start, 1.0)
    assert end[2] == pytest.approx(10.0 - 0.5 * GRAVITY, abs=1e-9)
    assert np.abs(end[10:]).max() < 1e-12


def test_half_axes_are_the_geoms_proportions_at_the_hull_s_volume():
    """Of the CUBE's box of half an edge 0.25 m: a ball of 0.125 m^3, which with its mass floats awash."""
    model = cube_sim.load_model(REPO / "models" / "cube.xml", {"water:surface": 0.0, "hull:mass": [62.5]})
    radius = (0.125 * 3.0 / 4.0 / pi) ** (1.0 / 3.0)
    assert abs(wrench_at(model, (0.0, 0.0, -0.02), (0.0, 0.0, 0.0))[2]) < 1e-9  # half of it under water: CB at z = 0
    h = 1e-6
    up, down = (wrench_at(model, (0.0, 0.0, -0.02 + dz), (0.0, 0.0, 0.0))[2] for dz in (-h, h))
    assert (up - down) / (2.0 * h) == pytest.approx(1000.0 * GRAVITY * pi * radius**2, rel=1e-7)


@pytest.mark.parametrize(("z", "share"), [(-1.0, 1.0), (-0.2, 0.5), (-0.2 - 0.0225, 0.84375), (0.0, 0.0)])
def test_a_thruster_fades_by_its_own_depth(z, share):
    """T1 of the CUBE lies 0.2 m above the origin, of 0.045 m radius: (2 + 3/2 - 1/8)/4 of it half a radius deep."""
    forces = []
    for surface in (0.0, 100.0):
        model = cube_sim.load_model(REPO / "models" / "cube.xml", {"water:surface": surface})
        data = mujoco.MjData(model)
        data.qpos[2], data.act[:] = z, 0.8
        mujoco.mj_forward(model, data)
        forces.append(data.actuator_force[0])
    assert forces[0] == pytest.approx(share * forces[1], rel=1e-12)
    assert forces[1] > 10.0


def test_the_compiled_law_at_the_surface_is_the_plain_one():
    rng = np.random.default_rng(19)
    model = at_surface(random_body(rng), np.array([0.3, 0.2, 0.12]))
    data = mujoco.MjData(model)
    for z in (-0.2, -0.05, 0.0, 0.15, 3.0):
        state = tumbling(rng)
        state[2] = z
        set_state(data, state)
        mujoco.mj_forward(model, data)
        compiled, inertia = data.qfrc_passive.copy(), data.M.copy()
        data.qfrc_passive[:] = 0.0
        callbacks()["passive"](model._address, data._address)
        np.testing.assert_allclose(data.qfrc_passive, compiled, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(data.M, inertia, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"water:surface": [0.0, 1.0]}, "water:surface: has 2 values; it takes 1"),
        ({"water:surface": np.inf}, "water:surface: holds a value that is not finite"),
        ({"hull:surface_half_axes": [0.1, 0.0, 0.1]}, "half-axes .* are positive"),
        ({"hull:surface_half_axes": [0.1]}, "has 1 value; it takes 3"),
    ],
)
def test_a_surface_that_cannot_be_is_refused(given, said):
    with pytest.raises(ModelError, match=said):
        cube_sim.load_model(REPO / "models" / "cube.xml", given)


@pytest.mark.parametrize("name", ["infante", "cube"])
def test_what_is_read_off_a_model_is_read_under_water(name):
    """At its reference pose each lies half out of the water."""
    file = MODELS / f"{name}.xml"
    deep, awash = cube_sim.load_model(file), cube_sim.load_model(file, {"water:surface": [0.0]})
    np.testing.assert_array_equal(awash.body_invweight0, deep.body_invweight0)
    np.testing.assert_array_equal(awash.dof_invweight0, deep.dof_invweight0)
    if name == "infante":
        of = [identify_planar_model(model, cube_sim.Vehicle.from_model(model)) for model in (deep, awash)]
        assert of[0] == of[1]
