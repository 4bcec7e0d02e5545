"""The path-following verdict: its linear model against the nonlinear one, closed forms, vehicles of known fate."""

from itertools import combinations

import numpy as np
import pytest
from actuation_vehicles import cube, hull_of, random_hull

from cube_sim.actuation.allowed import AllowedForces
from cube_sim.actuation.courses import courses
from cube_sim.actuation.hull import Hull
from cube_sim.actuation.linear_motion import linearise
from cube_sim.actuation.subspaces import subspaces
from cube_sim.actuation.verdict import Mission, Outcome, judge
from cube_sim.errors import ActuationError
from cube_sim.spatial import quaternion_from_rotation, rotation_from_quaternion, skew


def random_rotation(rng):
    q = rng.normal(size=4)
    return rotation_from_quaternion(q / np.linalg.norm(q))


def turned(R, theta):
    """R exp(S(theta)) for a small theta, orthonormal to rounding."""
    S = skew(theta)
    return rotation_from_quaternion(quaternion_from_rotation(R @ (np.eye(3) + S + S @ S / 2)))


def test_steady_wrench_is_what_the_equations_of_motion_ask_for():
    vehicle, rng = cube(), np.random.default_rng(1)
    hull = hull_of(vehicle)
    for _ in range(5):
        R, nu = random_rotation(rng), rng.normal(size=6)
        wanted = vehicle.dynamics.wrench(R, nu, np.zeros(6), np.zeros(3))
        assert np.allclose(hull.steady_wrench(nu, R.T[:, 2]), wanted, atol=1e-9)


def test_slopes_are_derivatives():
    rng = np.random.default_rng(2)
    hull, nu, R = random_hull(rng), rng.normal(size=6), random_rotation(rng)
    h = 1e-6
    for i, e in enumerate(np.eye(6)):
        slope = (hull.steady_wrench(nu + h * e, R.T[:, 2]) - hull.steady_wrench(nu - h * e, R.T[:, 2])) / (2 * h)
        assert np.allclose(hull.steady_wrench_slope(nu)[:, i], slope, atol=1e-6)
    for i, e in enumerate(np.eye(3)):
        ends = [hull.steady_wrench(nu, turned(R, s * h * e).T[:, 2]) for s in (1, -1)]
        assert np.allclose(-hull.restoring_slope(R.T[:, 2])[:, i], (ends[0] - ends[1]) / (2 * h), atol=1e-6)


@pytest.mark.parametrize("planar", [False, True])
def test_linear_motion_is_the_derivative_of_the_nonlinear_one(planar):
    rng = np.random.default_rng(3)
    hull = random_hull(rng)
    moving = [0, 1, 5] if planar else list(range(6))
    A = rng.normal(size=(len(moving), 4))
    R0 = np.eye(3) if planar else random_rotation(rng)
    v0 = np.array([0.5, 0.2, 0.0]) if planar else np.array([0.5, -0.2, 0.3])
    motion = linearise(hull, A, v0, R0.T[:, 2])
    M = hull.mass[np.ix_(moving, moving)]
    nu0 = np.r_[v0, 0, 0, 0]
    across = np.linalg.svd(v0[None, :])[2][1:]
    if planar:
        across = np.array([[-v0[1], v0[0], 0]]) / np.linalg.norm(v0)
    trim = hull.steady_wrench(nu0, R0.T[:, 2])

    def rates(theta, nu, F):
        R = turned(R0, theta)
        off_course = across @ (R0.T @ R @ nu[:3])
        net = A @ F - (hull.steady_wrench(nu, R.T[:, 2]) - trim)[moving]
        return np.r_[off_course, nu[3:][[2] if planar else slice(None)], np.linalg.solve(M, net)]

    h, c, r = 1e-6, len(across), 1 if planar else 3
    angles = [2] if planar else [0, 1, 2]
    for i in range(len(motion.names)):
        ends = []
        for s in (h, -h):
            theta, nu = np.zeros(3), nu0.copy()
            if c <= i < c + r:
                theta[angles[i - c]] = s
            elif i >= c + r:
                nu[moving[i - c - r]] += s
            ends.append(rates(theta, nu, np.zeros(4)))
        assert np.allclose(motion.drift[:, i], (ends[0] - ends[1]) / (2 * h), atol=1e-6), motion.names[i]
    for i, F in enumerate(np.eye(4)):
        assert np.allclose(motion.steer[:, i], rates(np.zeros(3), nu0, F) - rates(np.zeros(3), nu0, 0 * F))


def test_side_step_of_a_free_mass_is_the_closed_form():
    # Rest to rest in T with least integral of F^2: F = 6 m d / T^2 (1 - 2 t / T), so d = F_max T^2 / (6 m).
    m, force, T = 5.0, 3.0, 8.0
    hull = Hull(m * np.eye(6), np.zeros((6, 6)), np.zeros((6, 6)), 0.0, 0.0, np.zeros(3), np.zeros(3))
    motion = linearise(hull, np.array([[1.0, 0], [0, 1], [0, 0]]), np.array([0.4, 0, 0]), np.array([0, 0, 1.0]))
    step = motion.side_step(np.array([1.0, force]), T, most_turn_rad=1.0)
    assert step == pytest.approx(force * T**2 / (6 * m), rel=0.03)
    assert motion.loose(1.0, 1.0) == ("yaw",)


def test_side_step_is_zero_when_nothing_pushes_across():
    hull = Hull.neutral(0.3)
    motion = linearise(hull, np.array([[1.0], [0], [0]]), np.array([0.4, 0, 0]), np.array([0, 0, 1.0]))
    assert motion.side_step(np.ones(1), 5.0, 1.0) == 0.0


def verdict_of(rows, n=6, hull=None):
    return judge(subspaces(np.eye(n)[:, rows], length_m=0.35), hull)


def test_rank_is_not_the_verdict():
    assert verdict_of([0, 2], n=3).outcome is Outcome.STEERED  # unicycle, rank 2
    assert verdict_of([3, 4, 5]).outcome is Outcome.STUCK  # three torques, rank 3
    assert verdict_of([0, 1, 2, 3]).outcome is Outcome.ADRIFT  # rank 4
    assert "yaw" in verdict_of([0, 1, 2, 3]).reason
    assert verdict_of([0, 1, 2], n=3).outcome is Outcome.HOLONOMIC
    assert verdict_of([0], n=3).outcome is Outcome.ADRIFT


def test_restoring_moments_replace_missing_torques():
    torpedo = [0, 4, 5]
    assert verdict_of(torpedo).outcome is Outcome.ADRIFT
    assert verdict_of(torpedo).courses[0].loose == ("roll",)
    assert verdict_of(torpedo, hull=hull_of(cube())).outcome is Outcome.STEERED
    # {Fx, Mz} cannot climb: the neutrally buoyant hull keeps level.
    unicycle = verdict_of([0, 5], hull=hull_of(cube()))
    assert unicycle.outcome is Outcome.STUCK
    assert "15 deg" in unicycle.reason


def test_munk_moment_turns_a_slender_hull_that_nothing_else_turns():
    U, m_u, m_v, inertia = 0.3, 10.0, 20.0, 1.5
    slender = Hull(
        np.diag([m_u, m_v, m_v, 1.0, 1.0, inertia]), np.zeros((6, 6)), np.zeros((6, 6)), 0, 0, np.zeros(3), np.zeros(3)
    )
    pushes = np.array([[1.0, 0], [0, 1], [0, 0]])
    along = linearise(slender, pushes, np.array([U, 0, 0]), np.array([0, 0, 1.0]))
    growth = np.max(np.linalg.eigvals(along.drift).real)
    assert growth == pytest.approx(U * np.sqrt(m_u * (m_v - m_u) / (m_v * inertia)))
    # Sway makes the moment, so that sideways thrust steers; with equal masses nothing does.
    assert along.loose(1.0, 0.3) == ()
    assert verdict_of([0, 1], n=3).outcome is Outcome.ADRIFT


def judged(lost, limits=None, mission=None):
    vehicle = cube()
    keep = [i for i in range(8) if i not in lost]
    A = vehicle.actuation_matrix
    table = vehicle.thrusters.limits[keep] if limits is None else limits
    allowed = AllowedForces.from_limits(table, len(keep), dead_zones=False)
    actuation = subspaces(A[:, keep], length_m=subspaces(A).length_m)
    return judge(actuation, hull_of(vehicle), allowed, mission)


def test_cube_follows_after_every_single_and_double_loss():
    assert judged([]).outcome is Outcome.HOLONOMIC
    assert all(judged([lost]).outcome is Outcome.HOLONOMIC for lost in range(8))
    outcomes = [judged(pair, mission=Mission(inclinations_rad=(0.0,))).outcome for pair in combinations(range(8), 2)]
    assert outcomes.count(Outcome.HOLONOMIC) == 16
    assert outcomes.count(Outcome.STEERED) == 12


def test_courses_are_kept_by_their_forces_within_reach():
    vehicle = cube()
    hull, A = hull_of(vehicle), np.delete(vehicle.actuation_matrix, [0, 1, 2], axis=1)
    for inclination in (-0.2, 0.0, 0.3):
        found = courses(hull, subspaces(A, length_m=0.35), 0.3, inclination)
        assert found
        for course in found:
            assert np.linalg.norm(course.velocity) == pytest.approx(0.3)
            assert course.velocity @ course.up == pytest.approx(0.3 * np.sin(inclination))
            wanted = hull.steady_wrench(np.r_[course.velocity, 0, 0, 0], course.up)
            assert np.allclose(A @ course.forces, wanted, atol=1e-5)


def test_weak_thrusters_are_told_from_lost_ones():
    fast = judged([], limits=[-1.0, 1.0])
    assert fast.outcome is Outcome.STUCK
    assert "more force than the thrusters have" in fast.reason
    weak = judged([], limits=[-5.0, 5.0], mission=Mission(horizon_s=10.0, side_step_m=3.0))
    assert weak.outcome is Outcome.WEAK
    assert not weak.follows
    assert "3 m are asked for" in weak.reason


def test_mission_without_sense_is_refused():
    for mission in (
        Mission(speed_m_s=0),
        Mission(horizon_s=float("nan")),
        Mission(inclinations_rad=()),
        Mission(inclinations_rad=(2.0,)),
    ):
        with pytest.raises(ActuationError, match="mission"):
            judged([], mission=mission)


def test_quadratic_drag_damps_what_nothing_else_does():
    # Surge and yaw only, no linear drag: sway is stopped by quadratic drag alone, which has no slope at rest.
    hull = Hull(np.eye(6), np.zeros((6, 6)), np.eye(6), 0.0, 0.0, np.zeros(3), np.zeros(3))
    A, v0, up = np.array([[1.0, 0], [0, 0], [0, 1]]), np.array([0.5, 0, 0]), np.array([0, 0, 1.0])
    assert "sway" in linearise(hull, A, v0, up).loose(1.0, 1.0)
    assert linearise(hull, A, v0, up, np.full(6, 0.05)).loose(1.0, 1.0) == ()
    # Work lost per cycle of amplitude a by |v| v is that of the slope 8 a / (3 pi).
    t = np.linspace(0, 2 * np.pi, 20001)
    a, v = 0.3, 0.3 * np.cos(t)
    slope = hull.steady_wrench_slope(np.zeros(6), np.full(6, a))[1, 1]
    assert np.trapezoid(np.abs(v) * v * v, t) == pytest.approx(slope * np.trapezoid(v * v, t), rel=1e-6)
