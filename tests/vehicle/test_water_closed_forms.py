"""What hydrodynamics knows on paper: decays, speeds, periods, instabilities, invariants."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.water_bodies import (
    DENSITY,
    GRAVITY,
    Body,
    coriolis_matrix,
    flown,
    get_state,
    positive,
    random_body,
    set_state,
    tumbling,
)

from cube_sim.spatial import multiply, quaternion_from_euler, rotation_from_quaternion

MASS, ADDED, LINEAR, QUADRATIC = 12.0, 18.0, 3.0, 25.0  # added mass exceeds the mass: lagged schemes diverge here
HEADINGS = [(0.0, 0.0, 0.0), (0.0, 0.0, 1.1), (0.4, -0.8, 2.5), (np.pi, 0.0, 0.0), (0.0, np.pi / 2, 0.3)]


def isotropic(**changes) -> Body:
    """A neutrally buoyant sphere-like body: the same in every direction, so every axis has the closed form."""
    body = Body(
        mass=MASS,
        inertia_at_cg=0.5 * np.eye(3),
        volume=MASS / DENSITY,
        added=np.diag([ADDED] * 3 + [0.3] * 3),
        linear=np.diag([LINEAR] * 6),
        quadratic=np.diag([QUADRATIC] * 6),
    )
    return replace(body, **changes)


def pose(angles) -> np.ndarray:
    return np.concatenate([np.zeros(3), quaternion_from_euler(*angles), np.zeros(6)])


def pushed(model, start, force_W, duration):
    """State after a constant force in world axes."""
    data = mujoco.MjData(model)
    set_state(data, start)
    data.qfrc_applied[:3] = force_W
    mujoco.mj_step(model, data, nstep=round(duration / model.opt.timestep))
    return get_state(data)


@pytest.mark.parametrize("angles", HEADINGS)
@pytest.mark.parametrize("axis", range(3))
def test_free_decay(angles, axis):
    """(m + a) u' = -d u - q u|u|:  u(t) = d u0 e^-kt / (d + q u0 (1 - e^-kt)), k = d/(m + a)."""
    start, u0, t = pose(angles), 0.9, 2.0
    start[7 + axis] = u0
    decay = np.exp(-LINEAR * t / (MASS + ADDED))
    expected = LINEAR * u0 * decay / (LINEAR + QUADRATIC * u0 * (1.0 - decay))
    nu = flown(isotropic().model(timestep=0.005), start, t)[7:]
    assert nu[axis] == pytest.approx(expected, abs=1e-9)
    assert np.abs(np.delete(nu, axis)).max() < 1e-12


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)])
def test_step_response_and_terminal_speed(direction):
    """(m + a) u' = F - q u^2:  u(t) = sqrt(F/q) tanh(t sqrt(F q)/(m + a)), in any attitude along a body axis."""
    F, body = 40.0, isotropic(linear=np.zeros((6, 6)))
    model = body.model(timestep=0.005)
    for t in (0.25, 1.0, 20.0):
        v = pushed(model, pose((0.0, 0.0, 0.0)), F * np.array(direction), t)[7:10]
        expected = np.sqrt(F / QUADRATIC) * np.tanh(t * np.sqrt(F * QUADRATIC) / (MASS + ADDED))
        np.testing.assert_allclose(v, expected * np.array(direction), atol=1e-9)


def test_from_rest_the_acceleration_is_force_over_mass_and_added_mass():
    model = isotropic().model()
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 30.0
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(30.0 / (MASS + ADDED), rel=1e-14)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("heading", [0.0, 0.9, -2.0])
def test_roll_and_pitch_period(axis, heading):
    """A submerged pendulum with an added moment of inertia: (I + A) phi'' = -W BG sin(phi).

    The period at amplitude phi0 is 4 K(sin(phi0/2)) / omega0, from the arithmetic-geometric mean.
    """
    above, amplitude = 0.05, 0.3
    body = isotropic(cb=np.array([0.0, 0.0, above]), linear=np.zeros((6, 6)), quadratic=np.zeros((6, 6)))
    a, g = 1.0, np.cos(amplitude / 2)
    for _ in range(8):
        a, g = 0.5 * (a + g), np.sqrt(a * g)
    omega0 = np.sqrt(MASS * GRAVITY * above / (0.5 + 0.3))
    period = 2.0 * np.pi / (a * omega0)
    tilt = [0.0, 0.0]
    tilt[axis] = amplitude
    start = pose((0.0, 0.0, 0.0))
    start[3:7] = multiply(quaternion_from_euler(0, 0, heading), quaternion_from_euler(*tilt, 0.0))
    model = body.model(timestep=period / 400)
    end = flown(model, start, period)
    np.testing.assert_allclose(end, start, atol=1e-7)
    half = flown(model, start, period / 2)
    mirrored = quaternion_from_euler(*(-np.array(tilt)), 0.0)
    np.testing.assert_allclose(half[3:7], multiply(quaternion_from_euler(0, 0, heading), mirrored), atol=1e-7)


@pytest.mark.parametrize("heading", [0.0, 2.2])
def test_munk_instability_rate(heading):
    """Moving bluntly, a slender hull turns broadside: yaw grows as exp(lambda t),
    lambda = U sqrt(m11 (m22 - m11) / (m22 I66)), from the linearised Kirchhoff equations."""
    added = np.diag([2.0, 20.0, 20.0, 0.1, 0.4, 0.4])
    body = isotropic(added=added, linear=np.zeros((6, 6)), quadratic=np.zeros((6, 6)))
    m11, m22, I66, U = MASS + 2.0, MASS + 20.0, 0.5 + 0.4, 0.5
    rate = U * np.sqrt(m11 * (m22 - m11) / (m22 * I66))
    linearised = np.array([[0.0, -m11 * U / m22], [(m11 - m22) * U / I66, 0.0]])  # of (v, r)
    eigenvalues, modes = np.linalg.eig(linearised)
    growing = modes[:, np.argmax(eigenvalues.real)]
    start = pose((0.0, 0.0, heading))
    start[7], start[8], start[12] = U, 1e-6 * growing[0], 1e-6 * growing[1]
    model = body.model(timestep=0.005)
    t = 3.0
    end = flown(model, start, t)
    assert end[12] / start[12] == pytest.approx(np.exp(rate * t), rel=1e-5)


def test_a_cube_has_no_munk_moment():
    start = pose((0.2, 0.1, 0.0))
    start[7:10] = 0.5, -0.3, 0.4
    end = flown(isotropic().model(), start, 5.0)
    assert np.abs(end[10:]).max() < 1e-14


@pytest.mark.parametrize("seed", range(3))
def test_kirchhoff_invariants(seed):
    """Free motion in an ideal fluid keeps energy, |p| and p.h; the impulse p is even constant in world axes."""
    rng = np.random.default_rng(seed)
    body = random_body(rng, 3.0).neutral().ideal()
    M = body.rigid + body.added
    model = body.model(timestep=0.005)
    data = mujoco.MjData(model)
    start = tumbling(rng)
    set_state(data, start)

    def invariants():
        state = get_state(data)
        nu, R = state[7:], rotation_from_quaternion(state[3:7])
        p, h = M[:3] @ nu, M[3:] @ nu
        return np.array([0.5 * nu @ M @ nu, p @ p, p @ h, *(R @ p), *(R @ h + np.cross(state[:3], R @ p))])

    first, worst = invariants(), 0.0
    for _ in range(40):
        mujoco.mj_step(model, data, nstep=100)
        worst = max(worst, np.abs(invariants() - first).max() / np.abs(first).max())
    assert worst < 1e-6
    assert np.linalg.norm(get_state(data)[:3] - start[:3]) > 2.0


def test_floating_body_ends_in_the_current():
    body = isotropic(current=(0.2, -0.1, 0.05), cb=np.array([0.0, 0.0, 0.03]))
    end = flown(body.model(timestep=0.01), pose((0.3, 0.2, 1.0)), 120.0)
    np.testing.assert_allclose(rotation_from_quaternion(end[3:7]) @ end[7:10], body.current, atol=1e-6)


def test_current_only_shifts_the_frame():
    """Motion in a steady current is motion in still water seen from a frame that moves with the water."""
    rng = np.random.default_rng(4)
    body, start, t = random_body(rng, 3.0), tumbling(rng), 2.0
    body = replace(body, volume=body.mass / DENSITY)
    R = rotation_from_quaternion(start[3:7])
    still = start.copy()
    still[7:10] -= R.T @ np.array(body.current)
    moving = flown(body.model(), start, t)
    at_rest = flown(replace(body, current=(0.0, 0.0, 0.0)).model(), still, t)
    np.testing.assert_allclose(moving[:3] - np.array(body.current) * t, at_rest[:3], atol=1e-7)
    np.testing.assert_allclose(moving[3:7], at_rest[3:7], atol=1e-7)


def test_heading_invariance():
    """Turned about the vertical together with the current, everything turns with it."""
    rng = np.random.default_rng(12)
    body, start = random_body(rng, 3.0), tumbling(rng)
    plain = flown(body.model(), start, 2.0)
    for yaw in (0.7, 2.0, -3.0):
        turn = quaternion_from_euler(0.0, 0.0, yaw)
        R = rotation_from_quaternion(turn)
        turned = np.concatenate([R @ start[:3], multiply(turn, start[3:7]), start[7:]])
        end = flown(replace(body, current=tuple(R @ np.array(body.current))).model(), turned, 2.0)
        np.testing.assert_allclose(end[:3], R @ plain[:3], atol=1e-9)
        np.testing.assert_allclose(end[7:], plain[7:], atol=1e-9)


def test_hydrostatic_equilibrium_and_buoyancy():
    """Heavier or lighter than water: terminal speed sqrt((m - rho V) g / q), weight not acting on added mass."""
    for excess in (0.4, -0.4):
        body = isotropic(volume=(MASS - excess) / DENSITY, linear=np.zeros((6, 6)))
        v = flown(body.model(timestep=0.01), pose((0.0, 0.0, 0.0)), 60.0)[9]
        assert v == pytest.approx(-np.sign(excess) * np.sqrt(abs(excess) * GRAVITY / QUADRATIC), rel=1e-9)


def test_without_gravity_there_is_no_buoyancy():
    body = isotropic(volume=1.5 * MASS / DENSITY, cb=np.array([0.1, 0.0, 0.0]))
    model = body.model(extra='<option><flag gravity="disable"/></option>')
    end = flown(model, pose((0.3, 0.2, 0.0)), 1.0)
    assert np.abs(end[7:]).max() == 0.0


def ellipsoid_added_mass(semi_axes) -> np.ndarray:
    """Translational added mass over displaced mass, (3,), by Lamb's integrals (Hydrodynamics, art. 114)."""
    a = np.asarray(semi_axes, dtype=float)

    def shape(i):
        integrand = solve_ivp(
            lambda s, _: [
                np.prod(a) / ((a[i] ** 2 + (s / (1 - s))) * np.sqrt(np.prod(a**2 + s / (1 - s)))) / (1 - s) ** 2
            ],
            (0.0, 1.0 - 1e-9),
            [0.0],
            rtol=1e-10,
            atol=1e-12,
        )
        return integrand.y[0, -1]

    alpha = np.array([shape(i) for i in range(3)])
    return alpha / (2.0 - alpha)


def test_sphere_accelerates_under_half_its_displaced_mass():
    """Lamb's integrals give rho V / 2 for a sphere; released at half weight it starts at g/2 / (1/2 + 1/2)."""
    ratios = ellipsoid_added_mass([0.2, 0.2, 0.2])
    np.testing.assert_allclose(ratios, 0.5, atol=1e-4)
    volume = 4.0 / 3.0 * np.pi * 0.2**3
    displaced = DENSITY * volume
    body = Body(
        mass=0.5 * displaced,
        volume=volume,
        added=np.diag([*(ratios * displaced), 0.0, 0.0, 0.0]),
        inertia_at_cg=np.eye(3),
    )
    model = body.model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.qacc[2] == pytest.approx(GRAVITY * 0.5 / (0.5 + 0.5), rel=1e-3)


def test_prolate_spheroid_glides_stably_broadside_only():
    """Added mass of a 3:1 spheroid from Lamb's integrals: k1 = 0.122, k2 = 0.803 (Lamb, art. 114 and 115)."""
    ratios = ellipsoid_added_mass([0.6, 0.2, 0.2])
    np.testing.assert_allclose(ratios, [0.122, 0.803, 0.803], atol=2e-3)
    displaced = DENSITY * 4.0 / 3.0 * np.pi * 0.6 * 0.2 * 0.2
    body = Body(
        mass=displaced,
        volume=displaced / DENSITY,
        inertia_at_cg=displaced / 5.0 * np.diag([0.08, 0.4, 0.4]),
        added=np.diag([*(ratios * displaced), 0.0, 0.05 * displaced, 0.05 * displaced]),
    )
    model = body.model(timestep=0.01)
    ends = []
    for nose_first in (True, False):
        start = pose((0.0, 0.0, 0.0))
        start[7 if nose_first else 8] = 0.5
        start[12] = 1e-4
        ends.append(np.abs(flown(model, start, 8.0)[12]))
    assert ends[0] > 100 * 1e-4
    assert ends[1] < 2e-4


def test_random_ideal_fluid_momentum_balance():
    """d/dt of the impulse in world axes equals the applied force, whatever the couplings."""
    rng = np.random.default_rng(3)
    added = positive(rng, 6)
    body = isotropic(added=added * 8.0, linear=np.zeros((6, 6)), quadratic=np.zeros((6, 6)))
    M = body.rigid + body.added
    start = tumbling(rng)
    force = np.array([3.0, -2.0, 1.0])
    end = pushed(body.model(timestep=0.002), start, force, 1.0)

    def impulse(state):
        return rotation_from_quaternion(state[3:7]) @ (M[:3] @ state[7:])

    np.testing.assert_allclose(impulse(end) - impulse(start), force, atol=1e-8)
    assert np.abs(coriolis_matrix(M, start[7:]) @ start[7:]).max() > 1.0
