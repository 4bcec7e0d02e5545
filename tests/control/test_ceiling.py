"""How high a hull is asked to rise: by its lift in closed form, and by what keeps it below."""

from math import inf

import numpy as np
import pytest
from scipy.optimize import brentq, linprog
from support.places import MODELS
from support.plain_callbacks import plain
from support.vehicles import random_rotation

import cube_sim
from cube_sim.control import ceiling
from cube_sim.control.ceiling import HELD, SINKING_M_S, Ceiling, highest_held, keep_below, keep_under_surface, lift
from cube_sim.guidance.view_record import VIEW
from cube_sim.mission import prepare
from cube_sim.mission.ceiling import ceiling_of
from cube_sim.mission.hull import flown_hull
from cube_sim.scenario import load_mapping
from cube_sim.vehicle.floating import floating_height
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health


def scenario(name, surface_m=0.0, **given):
    path = {"type": "point", "position_m": [0, 0, -3], "heading_deg": 0}
    model = str(MODELS / f"{name}.xml")
    return {"schema_version": 1, "name": "held", "model": model, "seed": 1, "duration_s": 5, "path": path,
            "surface_m": surface_m, "initial": {"position_m": [0, 0, -3]}, "guidance": {"speed_m_s": 0.3},
            "checks": [{"kind": "allowed_forces"}], **given}  # fmt: skip


def seen(position, velocity, target, R):
    view = np.zeros(1, VIEW)
    view["row"][0, :3], view["frame"] = target, R
    view["error"], view["velocity"] = R.T @ (np.array(position) - target), R.T @ np.array(velocity)
    return view


@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "bluerov2_vectored", "rov6"])
@pytest.mark.parametrize("surface_m", [0.0, 2.5])
def test_the_highest_place_is_where_half_of_the_lift_holds_what_the_water_does_not(name, surface_m):
    """Sphere law of the cap, (1 + t)^2 (2 - t) / 4, solved for the height by another root finder."""
    loaded = load_mapping(scenario(name, surface_m))
    hull = flown_hull(loaded)
    model, vehicle = hull
    above = ceiling_of(hull, loaded.scenario)
    up, g = 120.0, 9.81
    half = 0.5 * (above.heights[-1] - above.heights[0])

    def lacks(height):
        t = (surface_m - height - vehicle.centre_of_buoyancy[2]) / half
        share = 1.0 if t >= 1.0 else 0.0 if t <= -1.0 else 0.25 * (1.0 + t) ** 2 * (2.0 - t)
        return vehicle.mass * g - share * vehicle.displaced_mass * g - HELD * up * above.at(height)[1]

    right = brentq(lacks, above.heights[0] - 1e-9, above.heights[-1])
    assert above.highest(up) == pytest.approx(right, abs=2e-4)
    assert above.highest(0.0) in (inf, pytest.approx(surface_m + floating_height(model, vehicle), abs=1e-3))
    heights = [above.highest(each) for each in (40.0, 80.0, 160.0)]
    assert heights == sorted(heights)


def test_one_that_sinks_whatever_it_does_is_held_by_no_surface():
    above = Ceiling(np.array([-0.2, 0.2]), np.array([10.0, 100.0]), np.ones(2))
    assert above.highest(10.0) == inf
    assert above.highest(40.0) < 0.2
    assert above.highest(300.0) == 0.2


def test_endless_water_has_none():
    loaded = load_mapping(scenario("cube", None))
    assert ceiling_of(flown_hull(loaded), loaded.scenario) is None
    assert prepare(loaded).controller.highest == inf


@pytest.mark.parametrize("name", ["cube", "bluerov2_heavy", "rov6"])
def test_the_most_lift_is_that_of_a_linear_programme(name):
    controller = prepare(load_mapping(scenario(name))).controller
    vehicle = Vehicle.from_model(cube_sim.load_model(MODELS / f"{name}.xml"))
    A, limits = vehicle.actuation_matrix, vehicle.thrusters.limits[:, [0, 3]]
    best = linprog(-A[2], A_eq=A[[0, 1, 3, 4, 5]], b_eq=np.zeros(5), bounds=limits)
    reserve = controller.most_up / -best.fun
    assert 0.9 < reserve <= 1.0 + 1e-9
    assert lift(*controller._budget, 0.4) == pytest.approx(0.4 * controller.most_up)


def test_no_facet_that_faces_up_is_no_lift():
    assert lift(np.array([[1.0, 0, 0, 0, 0, 0], [0, 0, -1.0, 0, 0, 0]]), np.ones(2), np.zeros(2), 1.0) == 0.0


@pytest.mark.parametrize("force", [-20.0, 15.0, 27.0])
@pytest.mark.parametrize("ratio", [1.0, 0.7])
def test_what_is_stuck_adds_to_the_lift_of_the_others_or_takes_from_it(force, ratio):
    """By a linear programme over the others, with the reserve that the budget keeps of them."""
    mission = prepare(load_mapping(scenario("cube")))
    A, limits = mission.ability.A, mission.ability.limits[:, [0, 3]].copy()
    reserve = mission.controller.most_up / lifted(A, limits)
    left = mission.ability.left(Health.whole(8).with_thruster(2, 0.0, force))
    budget = left.budget
    limits *= ratio * reserve
    limits[2] = force
    assert lift(budget.normals, budget.bounds, budget.held_shares, ratio) == pytest.approx(lifted(A, limits), rel=1e-6)


def lifted(A, limits):
    """The most lift of forces within limits (m,2) that make nothing else [N]."""
    return -linprog(-A[2], A_eq=A[[0, 1, 3, 4, 5]], b_eq=np.zeros(5), bounds=limits).fun


def test_with_less_voltage_it_is_asked_less_high_compiled_and_not():
    loaded = load_mapping(scenario("cube"))
    controller, of_plain = prepare(loaded).controller, plain(ceiling.__name__)
    table, budget = controller.ceiling.table, controller._budget
    heights = []
    for ratio in (1.0, 0.8, 0.5, 0.2):
        up = ratio * controller.most_up
        heights.append(highest_held(table, up))
        assert heights[-1] == of_plain.highest_held(table, up) == controller.ceiling.highest(up)
        view = seen([0.0, 0.0, heights[-1] - 0.1], [0.0, 0.0, 0.5], np.array([0.0, 0.0, 3.0]), np.eye(3))
        told = []
        for function in (keep_under_surface, of_plain.keep_under_surface):
            velocity, change = np.array([0.1, 0.0, 0.5]), np.zeros(3)
            record = view if function is keep_under_surface else view.view(np.recarray)
            function(table, *budget, ratio, record, velocity, change, 2.0)
            told.append((*velocity, *change))
        assert told[0] == told[1]
        assert told[0][2] == pytest.approx(0.05, abs=1e-9)  # 0.1 m in 2 s
    assert heights[0] == controller.highest
    assert (np.diff(heights) < -1e-3).all()


@pytest.mark.parametrize("seed", range(20))
def test_only_rising_beyond_is_taken_away_in_every_frame(seed):
    rng = np.random.default_rng(seed)
    R, position, target = random_rotation(rng), rng.normal(size=3), rng.normal(size=3)
    moving, velocity, acceleration = rng.normal(size=(3, 3))
    view, time, highest = seen(position, moving, target, R), 1.7, 0.1
    results = []
    for function in (keep_below, plain(ceiling.__name__).keep_below):
        wanted, change = velocity.copy(), acceleration.copy()
        function(view.view(np.recarray) if function is not keep_below else view, wanted, change, highest, time)
        results.append((wanted, change))
    (wanted, change), slow = results
    np.testing.assert_allclose(results[0], slow, rtol=0, atol=0)
    most = max((highest - position[2]) / time, -SINKING_M_S)
    np.testing.assert_array_equal(wanted[:2], velocity[:2])
    assert wanted[2] == pytest.approx(min(velocity[2], most), abs=1e-12)
    if velocity[2] <= most:
        np.testing.assert_array_equal(change, acceleration)
    elif most > -SINKING_M_S:
        assert change[2] == pytest.approx(-moving[2] / time, abs=1e-12)


@pytest.mark.parametrize("z", [-0.6, -0.25, -0.1, 0.2])
def test_the_readable_law_and_the_compiled_one_rise_alike(z):
    """`decide` part by part, as for code of the user's own, and in one call."""
    given = scenario("cube", path={"type": "point", "position_m": [0, 0, 0.3], "heading_deg": 0})
    given["initial"] = {"position_m": [0.2, 0.1, z], "velocity_m_s": [0.1, 0.0, 0.2]}
    answers = []
    for compiled in (True, False):
        mission = prepare(load_mapping(given))
        if not compiled:
            mission.controller._compiled = None
        state = cube_sim.vehicle.state.read_state(mission.vehicle, mission.data)
        answers.append(mission.controller.decide(state, np.zeros(6), 0.02))
    one, other = answers
    np.testing.assert_allclose(one.wrench, other.wrench, rtol=1e-12, atol=1e-12)
    assert one.velocity.tolist() == pytest.approx(other.velocity.tolist(), abs=1e-12)
