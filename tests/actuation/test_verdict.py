"""The path-following verdict: its linear model against the nonlinear one, closed forms, vehicles of known fate."""

import re
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import least_squares, linprog
from scipy.spatial.transform import Rotation
from support.vehicles import (
    ballasted,
    cube,
    random_hull,
    random_rotation,
    steady_wrench,
    turned,
    vehicle,
    weightless,
)

from cube_sim.actuation.attainable.attainable_set import attainable_set
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.actuation.path_following.best_trim import best_trims
from cube_sim.actuation.path_following.linear_motion import linearise
from cube_sim.actuation.path_following.reasons import percent
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.trim import trim_conditions
from cube_sim.actuation.path_following.verdict import Outcome, judge
from cube_sim.errors import ActuationError
from cube_sim.wrench.allowed_forces import AllowedForces

UP = np.array([0, 0, 1.0])


@pytest.mark.parametrize("planar", [False, True])
def test_linear_motion_is_the_derivative_of_the_nonlinear_one(planar):
    rng = np.random.default_rng(3)
    hull = random_hull(rng)
    moving = [0, 1, 5] if planar else list(range(6))
    A = rng.normal(size=(len(moving), 4))
    R0 = np.eye(3) if planar else random_rotation(rng)
    v0 = np.array([0.5, 0.2, 0.0]) if planar else np.array([0.5, -0.2, 0.3])
    motion = linearise(hull, A, v0, R0.T[:, 2])
    M = hull.total_mass[np.ix_(moving, moving)]
    nu0 = np.r_[v0, 0, 0, 0]
    aside = np.cross([0, 0, 1] if planar else R0.T[:, 2], v0)
    across = np.array([aside, np.cross(v0, aside)])[: 1 if planar else 2]
    across = across / np.linalg.norm(across, axis=1, keepdims=True)
    trim = steady_wrench(hull, nu0, R0.T[:, 2])

    def rates(theta, nu, F):
        R = turned(R0, theta)
        off_course = across @ (R0.T @ R @ nu[:3])
        net = A @ F - (steady_wrench(hull, nu, R.T[:, 2]) - trim)[moving]
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
        assert np.allclose(motion.A[:, i], (ends[0] - ends[1]) / (2 * h), atol=1e-6), motion.names[i]
    for i, F in enumerate(np.eye(4)):
        assert np.allclose(motion.B[:, i], rates(np.zeros(3), nu0, F) - rates(np.zeros(3), nu0, 0 * F))


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
    assert verdict_of(torpedo).trims[0].uncontrolled_modes == ("roll",)
    assert verdict_of(torpedo, hull=cube().dynamics).outcome is Outcome.STEERED
    # {Fx, Mz} cannot climb: the neutrally buoyant hull keeps level.
    unicycle = verdict_of([0, 5], hull=cube().dynamics)
    assert unicycle.outcome is Outcome.STUCK
    assert "15 deg" in unicycle.reason


def test_munk_moment_turns_a_slender_hull_that_nothing_else_turns():
    U, m_u, m_v, inertia = 0.3, 10.0, 20.0, 1.5
    slender = weightless(np.diag([m_u, m_v, m_v, 1.0, 1.0, inertia]))
    pushes = np.array([[1.0, 0], [0, 1], [0, 0]])
    along = linearise(slender, pushes, np.array([U, 0, 0]), np.array([0, 0, 1.0]))
    growth = np.max(np.linalg.eigvals(along.A).real)
    assert growth == pytest.approx(U * np.sqrt(m_u * (m_v - m_u) / (m_v * inertia)))
    # Sway makes the moment, so that sideways thrust steers; with equal masses nothing does.
    assert along.uncontrolled_modes(1.0, 0.3) == ()
    assert verdict_of([0, 1], n=3).outcome is Outcome.ADRIFT


def judged(lost, limits=None, requirements=None):
    vehicle = cube()
    keep = [i for i in range(8) if i not in lost]
    A = vehicle.actuation_matrix
    table = vehicle.thrusters.limits[keep] if limits is None else limits
    allowed = AllowedForces.from_limits(table, len(keep), dead_zones=False)
    actuation = subspaces(A[:, keep], length_m=subspaces(A).length_m)
    return judge(actuation, vehicle.dynamics, allowed, requirements)


@pytest.mark.flight
def test_cube_follows_after_every_single_and_double_loss():
    assert judged([]).outcome is Outcome.HOLONOMIC
    singles = [judged([lost]) for lost in range(8)]
    assert all(single.outcome is Outcome.STEERED and "67 deg of tilt" in single.reason for single in singles)
    pairs = [judged(pair, requirements=PathRequirements(inclinations_rad=(0.0,))) for pair in combinations(range(8), 2)]
    assert all(pair.outcome is Outcome.STEERED for pair in pairs)
    assert sum("all 6 components" in pair.reason for pair in pairs) == 16


def test_trim_conditions_are_kept_by_their_forces():
    vehicle = cube()
    hull, A = vehicle.dynamics, np.delete(vehicle.actuation_matrix, [0, 1, 2], axis=1)
    for inclination in (-0.2, 0.0, 0.3):
        found = trim_conditions(hull, subspaces(A, length_m=0.35), 0.3, inclination)
        assert found
        for condition in found:
            assert np.linalg.norm(condition.velocity) == pytest.approx(0.3)
            assert condition.velocity @ condition.up == pytest.approx(0.3 * np.sin(inclination))
            wanted = steady_wrench(hull, np.r_[condition.velocity, 0, 0, 0], condition.up)
            assert np.allclose(A @ condition.forces, wanted, atol=1e-5)


@pytest.mark.flight
def test_weak_thrusters_are_told_from_lost_ones():
    fast = judged([], limits=[-1.0, 1.0])
    assert fast.outcome is Outcome.STUCK
    assert "more force than the thrusters have" in fast.reason
    weak = judged([], limits=[-5.0, 5.0], requirements=PathRequirements(horizon_s=10.0, side_step_m=3.0))
    assert weak.outcome is Outcome.WEAK
    assert not weak.follows
    assert "3 m are asked for" in weak.reason


def test_requirements_without_sense_are_refused_by_the_figure_that_lacks_it():
    for requirements, message in (
        (PathRequirements(speed_m_s=0), r"speed is 0 m/s; it can be judged between 0.001 and 100 m/s"),
        (PathRequirements(speed_m_s=1e300), r"speed is 1e\+300 m/s"),
        (PathRequirements(speed_m_s=float("nan")), "speed is nan"),
        (PathRequirements(horizon_s=float("nan")), "horizon_s is nan; it must be positive"),
        (PathRequirements(inclinations_rad=()), "inclinations_rad"),
        (PathRequirements(inclinations_rad=(2.0,)), "at most 90 degrees"),
    ):
        with pytest.raises(ActuationError, match=message):
            judged([], requirements=requirements)


@pytest.mark.parametrize("speed", [0.001, 0.01, 0.1])
def test_a_slow_cube_is_as_controllable_as_a_fast_one(speed):
    level = PathRequirements(speed_m_s=speed, inclinations_rad=(0.0,))
    assert judged([], requirements=level).outcome is Outcome.HOLONOMIC
    assert judged([0, 1, 2], requirements=level).outcome is Outcome.STEERED


def test_quadratic_drag_damps_what_nothing_else_does():
    # Surge and yaw only, no linear drag: sway is stopped by quadratic drag alone, which has no slope at rest.
    hull = weightless(np.eye(6), np.eye(6))
    A, v0, up = np.array([[1.0, 0], [0, 0], [0, 1]]), np.array([0.5, 0, 0]), np.array([0, 0, 1.0])
    assert "sway" in linearise(hull, A, v0, up).uncontrolled_modes(1.0, 1.0)
    assert linearise(hull, A, v0, up, np.full(6, 0.05)).uncontrolled_modes(1.0, 1.0) == ()
    # Work lost per cycle of amplitude a by |v| v is that of the slope 8 a / (3 pi).
    t = np.linspace(0, 2 * np.pi, 20001)
    a, v = 0.3, 0.3 * np.cos(t)
    slope = hull.steady_wrench_slope(np.zeros(6), np.full(6, a))[1, 1]
    assert np.trapezoid(np.abs(v) * v * v, t) == pytest.approx(slope * np.trapezoid(v * v, t), rel=1e-6)


def judge_of(name, requirements=None, *, hull=None, limits=None, lost=()):
    v = vehicle(name)
    A = v.actuation_matrix if name not in ("jack", "infante") else v.actuation_matrix[[0, 1, 5]]
    keep = [i for i in range(A.shape[1]) if i not in lost]
    table = v.thrusters.limits[keep] if limits is None else limits
    allowed = AllowedForces.from_limits(table, len(keep), dead_zones=False)
    actuation = subspaces(A[:, keep], length_m=subspaces(A).length_m)
    return judge(actuation, v.dynamics if hull is None else hull, allowed, requirements)


def held_by_programme(A, table, wrench):
    return linprog(np.zeros(A.shape[1]), A_eq=A, b_eq=wrench, bounds=table[:, [0, -1]]).status == 0


@pytest.mark.parametrize("speed", [0.3, 0.6, 1.0, 1.5, 2.0])
def test_surge_and_yaw_follow_planar_paths_at_every_speed_infante_was_flown_at(speed):
    verdict = judge_of("infante", PathRequirements(speed_m_s=speed))
    assert verdict.outcome is Outcome.STEERED
    assert "turning by 30 deg at most" in verdict.reason
    assert verdict.trims[0].side_step_m == 1.0


def test_thrusters_that_only_push_forwards_use_their_kernel():
    v = vehicle("jack")
    forwards = np.array([0.0, 0.0, 0.4, 51.44])
    A = v.actuation_matrix[[0, 1, 5]]
    verdict = judge_of("jack", limits=np.tile(forwards, (4, 1)))
    assert verdict.outcome is Outcome.HOLONOMIC
    forces = verdict.trims[0].condition.forces
    assert np.all((forces >= -1e-9) & (forces <= 51.44))
    assert np.allclose(A @ forces, verdict.trims[0].condition.wrench, atol=1e-6)


def test_a_thruster_split_into_two_that_push_one_way_each_changes_nothing():
    v = vehicle("cube")
    A, T, level = v.actuation_matrix, v.thrusters.limits, PathRequirements(inclinations_rad=(0.0,))
    halves = np.vstack([np.column_stack([0 * T[:, 0], T[:, 3]]), np.column_stack([0 * T[:, 0], -T[:, 0]])])
    allowed = AllowedForces.from_limits(halves, 16, dead_zones=False)
    split = judge(subspaces(np.hstack([A, -A])), v.dynamics, allowed, level)
    assert (split.outcome, split.reason) == (Outcome.HOLONOMIC, judge_of("cube", level).reason)


@pytest.mark.parametrize(("name", "speed"), [("cube", 1.26), ("cube", 1.32), ("bluerov2_heavy", 0.88)])
def test_a_course_some_forces_hold_is_held(name, speed):
    v = vehicle(name)
    verdict = judge_of(name, PathRequirements(speed_m_s=speed))
    assert verdict.follows
    for trim in verdict.trims:
        assert held_by_programme(v.actuation_matrix, v.thrusters.limits, trim.condition.wrench)


def test_a_course_no_forces_hold_says_how_much_of_it_they_hold():
    v, level = vehicle("cube"), PathRequirements(speed_m_s=1.6, inclinations_rad=(0.0,))
    verdict = judge_of("cube", level)
    assert verdict.outcome is Outcome.STUCK
    (trim,) = verdict.trims
    assert f"they hold {int(100 * trim.share)} % of it in the best attitude" in verdict.reason
    A, T, wrench = v.actuation_matrix, v.thrusters.limits, trim.condition.wrench
    assert held_by_programme(A, T, 0.999 * trim.share * wrench)
    assert not held_by_programme(A, T, 1.001 * trim.share * wrench)


def test_any_attitude_asks_for_the_drag_along_every_body_direction():
    v = vehicle("cube_as_built")
    lost = [v.thrusters.names.index(name) for name in ("T2", "T3")]
    verdict = judge_of("cube_as_built", lost=lost)
    assert verdict.outcome is Outcome.STEERED
    assert "all 6 components" in verdict.reason
    share = float(re.search(r"along the body's \(.*\) it holds ([\d.]+) %", verdict.reason)[1]) / 100
    A, T = np.delete(v.actuation_matrix, lost, axis=1), np.delete(v.thrusters.limits, lost, axis=0)
    heave = steady_wrench(v.dynamics, np.r_[0, 0, 0.3, 0, 0, 0], UP)
    assert not held_by_programme(A, T, heave)
    assert not held_by_programme(A, T, 1.2 * share * heave)
    assert held_by_programme(A, T, 0.9 * share * heave)


def test_any_attitude_asks_for_the_righting_torque_of_every_tilt():
    v = vehicle("cube")
    stiff = replace(v.dynamics, centre_of_buoyancy=np.array([0, 0, 0.08]))
    verdict = judge_of("cube", hull=stiff)
    assert verdict.outcome is Outcome.STEERED
    tilt = int(re.search(r"up to (\d+) deg of tilt;", verdict.reason)[1])

    def held_at(degrees):
        s, c = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
        ups = [np.array([s * np.cos(a), s * np.sin(a), c]) for a in np.linspace(0, 2 * np.pi, 48, endpoint=False)]
        wrenches = [steady_wrench(stiff, np.zeros(6), up) for up in ups]
        return all(held_by_programme(v.actuation_matrix, v.thrusters.limits, wrench) for wrench in wrenches)

    assert held_at(tilt)
    assert not held_at(tilt + 1.5)


def test_components_that_limits_take_away_are_not_produced():
    A = np.array([[1, 1, 0], [0, 0, 1], [0.3, -0.3, 0]])
    hull = vehicle("jack").dynamics

    def of(limits):
        return judge(subspaces(A), hull, AllowedForces.from_limits(limits, 3, dead_zones=False))

    assert of([-40, 50]).outcome is Outcome.HOLONOMIC
    forwards = of([0, 50])
    assert forwards.outcome is Outcome.STEERED
    assert "but not any course in the plane at any heading" in forwards.reason
    assert "it holds 0 %" in forwards.reason
    blocked = of([[-40, 50], [-40, 50], [0, 0]])
    assert blocked.outcome is Outcome.STEERED
    assert "2 of 3 components" in blocked.reason
    assert of([0, 0]).outcome is Outcome.STUCK


def test_a_motion_nothing_restores_must_be_pushed_both_ways():
    limits = np.array([[-50.0, 50.0]] * 6)
    limits[3] = 0.0, 50.0
    allowed = AllowedForces.from_limits(limits, 6, dead_zones=False)
    rolling = judge(subspaces(np.eye(6), length_m=0.35), None, allowed)
    assert rolling.outcome is Outcome.ADRIFT
    assert rolling.reason.endswith("to both sides: roll")
    assert judge(subspaces(np.eye(6), length_m=0.35), cube().dynamics, allowed).outcome is Outcome.STEERED


def test_what_follows_with_a_thruster_fewer_follows():
    fast = PathRequirements(speed_m_s=0.9)
    assert judge_of("jack", fast, lost=(0, 3)).follows
    assert judge_of("jack", fast, lost=(0,)).follows
    assert judge_of("jack", fast).follows


def shares_of(R, hull, attainable, course_W):
    return attainable.share(np.array([steady_wrench(hull, np.r_[r.T @ course_W, 0, 0, 0], r[2]) for r in R]))


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "lost", "speed", "ballast_N", "least"),
    [
        ("bluerov2_heavy", (), 1.0, 0.0, 1.55),
        ("bluerov2_heavy", (0,), 1.0, 0.0, 1.44),
        ("cube_as_built", (0, 5), 1.0, 0.0, 1.54),
        ("cube", (3,), 0.3, 140.0, 1.1),
        ("cube", (), 1.6, 0.0, 0.81),
    ],
)
def test_the_best_trim_beats_all_random_ones(name, lost, speed, ballast_N, least):
    v, rng = vehicle(name), np.random.default_rng(11)
    hull = ballasted(v.dynamics, ballast_N)
    A, T = (np.delete(x, lost, axis=k) for x, k in ((v.actuation_matrix, 1), (v.thrusters.limits, 0)))
    allowed = AllowedForces.from_limits(T, len(T), dead_zones=False)
    actuation = subspaces(A, length_m=subspaces(v.actuation_matrix).length_m)
    attainable, tilt = attainable_set(actuation, allowed), -np.radians(15) if name == "bluerov2_heavy" else 0.0
    best = best_trims(hull, actuation, attainable, speed, tilt)[0]
    course_W = speed * np.array([np.cos(tilt), 0, np.sin(tilt)])
    assert best.velocity @ best.up == pytest.approx(course_W[2])
    assert np.allclose(best.wrench, steady_wrench(hull, np.r_[best.velocity, 0, 0, 0], best.up))
    share = attainable.share(best.wrench[None])[0]
    assert share > least
    assert share > np.max(shares_of([random_rotation(rng) for _ in range(3000)], hull, attainable, course_W))
    assert judge(actuation, hull, allowed, PathRequirements(speed_m_s=speed)).follows == (share > 1)


def in_trim(R, hull, actuation, course_W):
    """The attitudes next to R in which the thrusters make the wrench, by somebody else's least squares."""
    missing = np.eye(6) - actuation.projector

    def wrench(R):
        return steady_wrench(hull, np.r_[R.T @ course_W, 0, 0, 0], R[2])

    found = [
        least_squares(lambda x, r=r: missing @ wrench(r @ Rotation.from_rotvec(x).as_matrix()), 0.01 * UP) for r in R
    ]
    return [r @ Rotation.from_rotvec(f.x).as_matrix() for r, f in zip(R, found, strict=True) if f.cost < 1e-12]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "lost", "speed", "ballast_N", "rank", "least"),
    [
        ("cube", (0, 3), 2.0, 0.0, 5, 0.465),
        ("cube", (4, 5, 6), 0.3, 60.0, 4, 1.214),
        ("cube_as_built", (0, 5, 7), 1.05, 0.0, 5, 1.05),
        ("bluerov2_heavy", (0, 1, 7), 1.2, 0.0, 5, 0.55),
    ],
)
def test_the_best_trim_without_some_components_beats_all_random_ones(name, lost, speed, ballast_N, rank, least):
    v, rng = vehicle(name), np.random.default_rng(12)
    hull = ballasted(v.dynamics, ballast_N)
    A, T = np.delete(v.actuation_matrix, lost, axis=1), np.delete(v.thrusters.limits, lost, axis=0)
    allowed = AllowedForces.from_limits(T, len(T), dead_zones=False)
    actuation = subspaces(A, length_m=subspaces(v.actuation_matrix).length_m)
    assert actuation.rank == rank
    attainable, course_W = attainable_set(actuation, allowed), np.array([speed, 0, 0])
    best = best_trims(hull, actuation, attainable, speed, 0.0)[0]
    assert actuation.reachable(best.wrench, 1e-6)
    share = attainable.share(best.wrench[None])[0]
    others = in_trim([random_rotation(rng) for _ in range(60)], hull, actuation, course_W)
    assert len(others) > 30
    assert share > least
    assert share > 0.999 * np.max(shares_of(others, hull, attainable, course_W))
    verdict = judge(actuation, hull, allowed, PathRequirements(speed_m_s=speed, inclinations_rad=(0.0,)))
    assert verdict.follows == (share > 1)
    assert verdict.follows or f"they hold {int(100 * share)} % of it in the best attitude" in verdict.reason


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "lost", "speed", "ballast_N", "weaker", "one_way", "least"),
    [
        ("cube_as_built", (), 0.205, -81.3, 18.0, False, 0.1244),  # a ridge, on which steps at random stop at 0.122
        ("bluerov2_heavy", (2, 1), 1.158, 0.0, 22.6, True, 0.0150),  # in most attitudes 0: some force must reverse
    ],
)
def test_the_best_trim_is_found_on_ridges_and_where_most_are_worth_nothing(
    name, lost, speed, ballast_N, weaker, one_way, least
):
    v = vehicle(name)
    hull = ballasted(v.dynamics, ballast_N)
    A, T = np.delete(v.actuation_matrix, lost, axis=1), np.delete(v.thrusters.limits, lost, axis=0) / weaker
    if one_way:
        T[:, :2] = 0.0
    allowed = AllowedForces.from_limits(T, len(T), dead_zones=False)
    actuation = subspaces(A, length_m=subspaces(v.actuation_matrix).length_m)
    attainable = attainable_set(actuation, allowed)
    tilt = -np.radians(15) if not lost else 0.0
    best = best_trims(hull, actuation, attainable, speed, tilt)[0]
    assert attainable.share(best.wrench[None])[0] > least
    assert held_by_programme(A, T, 0.999 * least * actuation.projector @ best.wrench)


def test_in_the_plane_the_best_heading_is_found():
    v, speed = vehicle("jack"), 2.0
    A = v.actuation_matrix[[0, 1, 5]]
    actuation, hull = subspaces(A), v.dynamics
    attainable = attainable_set(actuation, AllowedForces.from_limits(v.thrusters.limits, 4, dead_zones=False))
    best = best_trims(hull, actuation, attainable, speed, 0.0)[0]
    assert best.up == pytest.approx(UP)
    headings = np.linspace(0, 2 * np.pi, 2000)
    moving = np.column_stack([np.cos(headings), -np.sin(headings), 0 * headings]) * speed
    shares = attainable.share(hull.steady_wrenches(moving, np.tile(UP, (2000, 1)))[:, [0, 1, 5]])
    assert attainable.share(best.wrench[None])[0] >= np.max(shares) - 1e-9


@pytest.mark.flight
def test_a_vehicle_follows_where_it_does_with_a_thruster_fewer():
    fast = PathRequirements(speed_m_s=1.0, inclinations_rad=(-np.radians(15),))
    assert all(judge_of("bluerov2_heavy", fast, lost=lost).follows for lost in ((), (4,), (4, 0)))


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.9999999, "99 %"),
        (0.0999, "9.9 %"),
        (0.10, "10 %"),
        (0.00356, "0.35 %"),
        (1e-7, "less than 0.01 %"),
        (0, "0 %"),
    ],
)
def test_a_share_is_rounded_down_in_plain_digits(share, text):
    assert percent(share) == text


def test_a_share_just_short_of_all_is_not_all():
    reason = judge_of("cube_as_built", PathRequirements(speed_m_s=0.7)).reason
    assert "it holds 99 % in the worst attitude" in reason
