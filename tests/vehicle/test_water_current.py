"""A current that varies with time and depth."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.water_bodies import DENSITY, Body, flown, fossen, get_state, random_body, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle.current import set_current, still_water, water_velocity
from cube_sim.vehicle.laws import current


def table(times, heights, velocities) -> np.ndarray:
    """Rows of `water:current` from velocities (n_t, n_z, 3)."""
    return np.array([[t, z, *velocities[i][j]] for i, t in enumerate(times) for j, z in enumerate(heights)]).ravel()


def with_current(body: Body, rows: np.ndarray, timestep: float = 0.005) -> mujoco.MjModel:
    return cube_sim.load_model(body.spec(timestep=timestep), {"water:current": rows})


def test_one_row_is_a_steady_current():
    rng = np.random.default_rng(0)
    body, start = random_body(rng), tumbling(rng)
    still = replace(body, current=(0.0, 0.0, 0.0))
    rows = np.array([0.0, 0.0, *body.current])
    np.testing.assert_allclose(
        flown(with_current(still, rows), start, 1.0), flown(body.model(), start, 1.0), atol=1e-13
    )


def test_it_adds_to_the_steady_one():
    rng = np.random.default_rng(1)
    body, start = random_body(rng), tumbling(rng)
    half = tuple(0.5 * np.array(body.current))
    rows = np.array([0.0, 0.0, *half])
    np.testing.assert_allclose(
        flown(with_current(replace(body, current=half), rows), start, 1.0), flown(body.model(), start, 1.0), atol=1e-13
    )


def test_table_against_scipy():
    """Bilinear inside, constant outside; the acceleration is the change along the water's own path over one step."""
    from scipy.interpolate import RegularGridInterpolator

    rng = np.random.default_rng(2)
    times, heights = np.array([0.0, 1.0, 2.5, 4.0]), np.array([-9.0, -4.0, -1.0])
    values = rng.normal(size=(4, 3, 3))
    steady = (0.1, -0.2, 0.3)
    expected = RegularGridInterpolator((times, heights), values)
    h = 0.04

    def at(t, z):
        return current.current_at(t, z, times, heights, values.reshape(-1, 3), steady, h)

    def inside(t, z):
        return np.clip([t, z], [0.0, -9.0], [4.0, -1.0])

    for t, z in rng.uniform([-1.0, -11.0], [5.0, 1.0], (200, 2)):
        v, a = at(t, z)
        np.testing.assert_allclose(v, expected(inside(t, z))[0] + steady, atol=1e-12)
        before = min(t, h / 2) if t >= 0.0 else h / 2
        change = expected(inside(t + h / 2, z + h / 2 * v[2])) - expected(inside(t - before, z - before * v[2]))
        np.testing.assert_allclose(a, change[0] / (h / 2 + before), atol=1e-12)


@pytest.mark.flight
@pytest.mark.parametrize(
    ("times", "held"),
    [((0.0, 0.5, 1.0, 1.5, 2.0, 3.5), 1e-7), ((0.0, 0.503, 1.011, 1.517, 2.031, 3.5), 1e-5)],
    ids=["points on steps", "points between steps"],
)
def test_the_points_of_a_table_cost_no_order(times, held):
    """RK4 at 10 ms against the equations of relative motion, integrated from point to point of the table by DOP853.

    The acceleration of the water jumps at every point. Taken as it stands at each stage, it costs 2 mm and the order.
    """
    rng = np.random.default_rng(0)
    body, start = replace(random_body(rng), current=(0.0, 0.0, 0.0)), tumbling(rng)
    t = np.array(times)
    v = np.stack([0.3 * np.sin(1.3 * t), 0.2 * np.cos(2.0 * t), 0.1 * np.sin(t)], axis=1)
    end = flown(with_current(body, table(t, [0.0], v[:, None]), 0.01), start, 3.0)
    state = start.copy()
    for i in range(len(t) - 1):
        slope = (v[i + 1] - v[i]) / (t[i + 1] - t[i])

        def motion(s, y, i=i, slope=slope):
            """Fossen's model at this instant's current, with the force of water that speeds up added."""
            R = rotation_from_quaternion(y[3:7] / np.linalg.norm(y[3:7]))
            a = np.concatenate([R.T @ slope, np.zeros(3)])
            pushed = DENSITY * body.volume * np.concatenate([a[:3], np.cross(body.cb, a[:3])])
            return fossen(replace(body, current=tuple(v[i] + slope * (s - t[i]))), y, body.added @ a + pushed)

        solution = solve_ivp(motion, (t[i], min(t[i + 1], 3.0)), state, method="DOP853", rtol=1e-11, atol=1e-12)
        state = solution.y[:, -1]
    np.testing.assert_allclose(end[:3], state[:3], rtol=0.0, atol=held)


def test_a_drifter_stays_with_water_that_accelerates():
    """Neutral, CG = CB, no drag, moving with the water at first: it is carried along exactly, whatever its added mass.

    Only the full inertia force (M_A + rho V) Dv/Dt does that; with M_A alone, or none, it lags.
    """
    rng = np.random.default_rng(3)
    body = random_body(rng).neutral().ideal()
    velocities = np.array([[[0.1, 0.0, 0.2]], [[0.9, -0.6, -0.6]]])
    model = with_current(body, table([0.0, 8.0], [0.0], velocities))
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    R = rotation_from_quaternion(q)
    start = np.concatenate([np.zeros(3), q, R.T @ velocities[0, 0], np.zeros(3)])
    end = flown(model, start, 4.0)
    half_way = 0.5 * (velocities[0, 0] + velocities[1, 0])
    np.testing.assert_allclose(end[:3], 2.0 * (velocities[0, 0] + half_way), atol=1e-9)
    np.testing.assert_allclose(rotation_from_quaternion(end[3:7]) @ end[7:10], half_way, atol=1e-9)
    assert np.abs(end[10:]).max() < 1e-9


def test_relative_motion_is_that_in_still_water():
    """Seen from water that accelerates as a whole, a neutral drifter with CG = CB moves as in still water."""
    rng = np.random.default_rng(4)
    body, start = random_body(rng), tumbling(rng)
    body = replace(body.neutral(), current=(0.0, 0.0, 0.0))
    velocities = np.array([[[0.0, 0.0, 0.0]], [[0.6, -0.3, 0.2]]])
    moving = flown(with_current(body, table([0.0, 6.0], [0.0], velocities)), start, 3.0)
    still = flown(body.model(), start, 3.0)
    np.testing.assert_allclose(moving[:3] - 0.75 * velocities[1, 0], still[:3], atol=1e-8)
    np.testing.assert_allclose(moving[3:7], still[3:7], atol=1e-8)
    np.testing.assert_allclose(moving[10:], still[10:], atol=1e-8)


def test_sinking_through_shear():
    """A heavy sphere falls through a current that grows with depth; an ODE in world axes says where it goes."""
    m, a, d, volume = 12.0, 6.0, 8.0, 11.0 / DENSITY
    body = Body(mass=m, volume=volume, inertia_at_cg=np.eye(3), added=np.diag([a] * 3 + [0.2] * 3))
    body = replace(body, linear=np.diag([d] * 3 + [1.0] * 3))
    model = with_current(body, table([0.0], [-10.0, 0.0], np.array([[[0.8, 0.4, 0.0], [0.0, 0.0, 0.0]]])), 0.01)
    end = flown(model, np.array([0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), 6.0)

    def motion(t, y):
        v_c = np.array([0.8, 0.4, 0.0]) * -y[2] / 10.0
        force = -d * (y[3:] - v_c) + np.array([0.0, 0.0, -9.81]) * (m - DENSITY * volume)
        return np.concatenate([y[3:], force / (m + a)])

    expected = solve_ivp(motion, (0.0, 6.0), np.zeros(6), rtol=1e-11, atol=1e-12).y[:, -1]
    assert expected[0] > 0.3
    np.testing.assert_allclose(end[:3], expected[:3], atol=1e-8)


def test_the_current_changes_while_the_model_is_in_use():
    body = Body(volume=0.01, linear=np.eye(6) * 20.0)
    model = with_current(body, table([0.0], [0.0], np.zeros((1, 1, 3))), 0.01)
    data = mujoco.MjData(model)
    set_current(model, [[[0.0, 0.5, 0.0]]])
    mujoco.mj_step(model, data, nstep=1000)
    np.testing.assert_allclose(get_state(data)[7:10], [0.0, 0.5, 0.0], atol=1e-6)
    with pytest.raises(ModelError, match=r"shape \(1, 1, 3\), not \(3,\)"):
        set_current(model, [0.0, 0.0, 0.0])
    with pytest.raises(ModelError, match=r"use model\.opt\.wind"):
        set_current(body.model(), [[[0.0, 0.0, 0.0]]])


def test_all_of_the_water_can_be_stilled_for_a_while_and_moves_on_as_before():
    model = with_current(Body(volume=0.01), table([0.0, 9.0], [-3.0], np.array([[[0.1, 0.5, 0.0]], [[0.3, 0.0, 0.2]]])))
    model.opt.wind[:] = [0.0, 0.2, -0.1]
    before = [water_velocity(model, t, -3.0) for t in (0.0, 4.0, 9.0)]
    with still_water(model):
        np.testing.assert_array_equal([water_velocity(model, t, -3.0) for t in (0.0, 4.0, 9.0)], np.zeros((3, 3)))
    np.testing.assert_array_equal([water_velocity(model, t, -3.0) for t in (0.0, 4.0, 9.0)], before)


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([0.0, 0.0, 1.0], "has 3 values; it takes rows of five"),
        ([0.0, 0.0, 0.0, np.nan, 0.0], "not finite"),
        ([0, 0, 1, 0, 0, 1, -5, 1, 0, 0], "has 2 rows; one for each of its 2 times at each of its 2 heights"),
        ([0, 0, 1, 0, 0, 0, 0, 1, 0, 0], "has 2 rows; one for each of its 1 times"),
    ],
)
def test_a_table_with_holes_is_refused(rows, reason):
    with pytest.raises(ModelError) as caught:
        with_current(Body(), np.array(rows, dtype=float))
    assert caught.value.element == "water:current"
    assert reason in str(caught.value)


def test_rows_in_any_order():
    rng = np.random.default_rng(6)
    rows = table([0.0, 1.0], [-2.0, 0.0], rng.normal(size=(2, 2, 3)) * 0.2).reshape(-1, 5)
    body = Body(volume=0.01, linear=np.eye(6) * 5.0, added=np.eye(6))
    ends = []
    for order in (slice(None), [2, 0, 3, 1]):
        model = with_current(body, rows[order].ravel())
        data = mujoco.MjData(model)
        set_state(data, np.array([0, 0, -1.0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]))
        mujoco.mj_step(model, data, nstep=100)
        ends.append(get_state(data))
    np.testing.assert_array_equal(*ends)


def test_the_velocity_of_the_water_can_be_asked_for():
    """Steady current and table together, bilinear inside and constant outside."""
    rows = table([0.0], [-9.0, -4.0], [[(0.2, 0.0, 0.0), (0.0, 0.3, 0.0)]])
    body = replace(random_body(np.random.default_rng(5)), current=(0.05, 0.0, 0.0))
    model = with_current(body, rows)
    np.testing.assert_allclose(water_velocity(model, 0.0, -12.0), [0.25, 0.0, 0.0])
    np.testing.assert_allclose(water_velocity(model, 9.0, -6.5), [0.15, 0.15, 0.0])
    np.testing.assert_allclose(water_velocity(model, 0.0, 3.0), [0.05, 0.3, 0.0])
    assert water_velocity(body.model(), 1.0, -5.0) == pytest.approx(body.current)
