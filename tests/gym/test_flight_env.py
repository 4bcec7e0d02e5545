"""A scenario as an environment: Gymnasium's own checker, the same bits for the same seed, and what ends a flight."""

import subprocess
import sys
import warnings
from dataclasses import replace
from math import pi

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.places import HELIX, SCENARIOS

import cube_sim
from cube_sim.errors import FlightError, ScenarioError
from cube_sim.gym import IDS, FlightEnv, FollowingReward, Stepped, make_vec
from cube_sim.spatial import State, quaternion_from_euler, rotation_from_quaternion
from cube_sim.vehicle.compiled_once import CompiledOnce

HOLD = "cube_sim/CubeHold-v0"
HOVER = SCENARIOS / "cube_hover.yaml"
SHORT = {"duration_s": 1.0, "checks": [{"kind": "allowed_forces"}]}
RANDOM = {
    "scenario": {"current_m_s": [[-0.3] * 3, [0.3] * 3], "guidance.speed_m_s": {"one_of": [0.2, 0.4]}},
    "model": {
        "hull:added_mass": [0.7, 1.3],
        "hull:quadratic_damping": [[0.7] * 6, [1.3] * 6],
        "hull:mass": [0.95, 1.05],
        "hull:inertia": [[0.9] * 3, [1.1] * 3],
        "hull:thruster_lag": [0.5, 2.0],
        "hull:thruster_characteristic": [0.9, 1.1],
    },
    "thrusters": [0.8, 1.0],
    "faults": {"most": 2, "at_s": [0.0, 0.3], "states": ["dead", "weak", "stuck"]},
}


def flown(env, seed, action=None):
    """All observations and rewards of a flight whose actions are the seed's too."""
    seen, _ = env.reset(seed=seed)
    rng, rows = np.random.default_rng(seed), [seen]
    while True:
        asked = rng.uniform(-0.3, 0.3, env.action_space.shape) if action is None else action
        seen, reward, terminated, truncated, info = env.step(asked)
        rows.append(np.append(seen, reward))
        if terminated or truncated:
            return rows, info


def same(one, other):
    return all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("action", ["wrench", "forces", "commands"])
def test_gymnasium_finds_nothing_wrong(action):
    env = gymnasium.make(HOLD, action=action, randomise={"scenario": {"current_m_s": [[-0.1] * 3, [0.1] * 3]}})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)


@pytest.mark.parametrize("name", IDS)
def test_every_id_is_made_and_steps(name):
    env = gymnasium.make(name)
    seen, _ = env.reset(seed=1)
    assert seen in env.observation_space
    seen, reward, terminated, truncated, info = env.step(np.zeros(env.action_space.shape))
    assert seen in env.observation_space
    assert np.isfinite(reward)
    assert (terminated, truncated, info["ended"]) == (False, False, "")


def test_the_same_seed_is_the_same_flight_to_the_bit_and_another_is_another():
    env = FlightEnv(HOVER, SHORT, randomise=RANDOM, ticks=5)
    one, _ = flown(env, 3)
    assert same(one, flown(env, 3)[0])
    assert same(one, flown(FlightEnv(HOVER, SHORT, randomise=RANDOM, ticks=5), 3)[0])
    assert not same(one, flown(env, 4)[0])
    env.reset(seed=3)
    drawn = env.flight.mission
    env.reset()
    after = env.flight.mission
    assert drawn.scenario.current_m_s != after.scenario.current_m_s
    assert not np.array_equal(drawn.vehicle.added_mass, after.vehicle.added_mass)


def test_sensors_have_other_noise_with_another_seed_and_the_agent_sees_the_estimate():
    env = FlightEnv(SCENARIOS / "cube_navigated.yaml", SHORT)
    flights = [flown(env, seed, np.zeros(6))[0][-1] for seed in (5, 5, 6)]
    assert flights[0].tobytes() == flights[1].tobytes()
    assert not np.array_equal(flights[0], flights[2])
    seen = env.flight.observation()
    assert not np.array_equal(seen.estimate.velocity, seen.state.velocity)
    np.testing.assert_array_equal(flights[2][env.layout.at("velocity")], seen.estimate.velocity)


def test_what_was_drawn_can_be_flown_again_as_a_scenario():
    env = FlightEnv(HELIX, SHORT, randomise=RANDOM)
    env.reset(seed=8)
    again = cube_sim.Flight(env.loaded).mission
    np.testing.assert_array_equal(again.vehicle.added_mass, env.flight.mission.vehicle.added_mass)
    assert again.scenario.events == env.flight.mission.scenario.events
    assert again.scenario.seed == env.reset(seed=8)[1]["seed"]


def test_the_vector_says_where_the_vehicle_is():
    """Half a metre ahead of a point to hold, turned by a quarter."""
    level = {"path.heading_deg": 0.0, "control.attitude": {"mode": "fixed", "attitude_deg": [0.0] * 3}}
    env = FlightEnv(HOVER, {**SHORT, **level})
    q = quaternion_from_euler(0.0, 0.0, pi / 2)
    there = State(np.array([0.5, 0.0, -5.0]), q, rotation_from_quaternion(q), np.array([0.1, 0.2, 0.3]), np.zeros(3))
    seen, _ = env.reset(seed=0, options={"state": there})
    at = env.layout.at
    np.testing.assert_allclose(seen[at("error")], [0.5, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(seen[at("attitude")], [0.0, 0.0, -pi / 2], atol=1e-9)
    np.testing.assert_allclose(seen[at("velocity")], [0.1, 0.2, 0.3], atol=1e-12)
    np.testing.assert_allclose(seen[at("up")], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(seen[at("ways")][:3], [0.0, 0.5, 0.0], atol=1e-12)
    np.testing.assert_allclose(seen[at("tangents")][:3], [0.0, -1.0, 0.0], atol=1e-12)
    with pytest.raises(KeyError, match="there are error, attitude"):
        at("depth")


def test_the_path_ahead_is_the_path():
    env = FlightEnv(HELIX, SHORT, ahead_m=(1.0, 3.0))
    seen, info = env.reset(seed=0)
    state, view = info["observation"].state, info["observation"].view
    ways, tangents = (seen[env.layout.at(name)].reshape(2, 3) for name in ("ways", "tangents"))
    for way, tangent, distance in zip(ways, tangents, (1.0, 3.0), strict=True):
        point = env.flight.mission.path.at(view.arc_length + distance)
        np.testing.assert_allclose(state.position + state.rotation @ way, point.position, atol=1e-9)
        np.testing.assert_allclose(state.rotation @ tangent, point.rotation[:, 0], atol=1e-12)


@pytest.mark.parametrize("kind", ["wrench", "forces", "commands"])
def test_an_action_of_one_is_what_the_thrusters_can_make(kind):
    env = FlightEnv(HOVER, SHORT, action=kind)
    thrusters, A = env.flight.mission.vehicle.thrusters, env.flight.mission.vehicle.actuation_matrix
    limits = thrusters.limits
    rng = np.random.default_rng(2)
    share = rng.uniform(-1.0, 1.0, env.scale.low.shape)
    np.testing.assert_allclose(env.scale.share(env.scale.asked(share)), share, atol=1e-12)
    if kind == "wrench":
        made = rng.uniform(limits[:, 0], limits[:, 3], (2000, len(limits))) @ A.T
        assert (made >= env.scale.low).all()
        assert (made <= env.scale.high).all()
        corner = np.where(A[0] > 0.0, limits[:, 3], limits[:, 0])
        assert A[0] @ corner == pytest.approx(env.scale.high[0])
    elif kind == "forces":
        np.testing.assert_array_equal(env.scale.asked(np.ones(len(limits))), limits[:, 3])
        np.testing.assert_array_equal(env.scale.asked(-2.0 * np.ones(len(limits))), limits[:, 0])
    env.reset(seed=0)
    given = env.scale.asked(share)
    env.step(share)
    if kind != "wrench":
        commands = thrusters.command(given) if kind == "forces" else given
        np.testing.assert_allclose(env.flight.signals["thrusters.command"][0, 1:], commands)


def test_a_flight_ends_far_away_early_and_in_time():
    still = np.zeros(6)
    _, info = flown(FlightEnv(HOVER, {**SHORT, "initial.velocity_m_s": [3.0, 0.0, 0.0]}, too_far_m=0.5), 0, still)
    assert "from the target" in info["ended"]
    _, info = flown(FlightEnv(HOVER, {**SHORT, "initial.velocity_m_s": [1e5, 0.0, 0.0]}), 0, still)
    assert "acceleration" in info["ended"]
    env = FlightEnv(HOVER, SHORT, ticks=7)
    rows, info = flown(env, 0, still)
    assert info["ended"] == ""
    assert len(rows) == 1 + 8  # 50 ticks, the last step is short
    with pytest.raises(FlightError, match="over"):
        env.step(still)


def test_a_reward_of_ones_own_sees_the_step():
    steps: list[Stepped] = []
    env = FlightEnv(HOVER, SHORT, ticks=2, reward=lambda stepped: steps.append(stepped) or 7.0)
    env.reset(seed=0)
    assert env.step(np.full(6, 0.1))[1] == 7.0
    (stepped,) = steps
    assert stepped.after.time_s - stepped.before.time_s == pytest.approx(stepped.dt) == pytest.approx(0.04)
    np.testing.assert_array_equal(stepped.action, 0.1)


def test_the_default_reward_is_its_formula():
    env = FlightEnv(HELIX, SHORT)
    env.reset(seed=0)
    before = env.flight.observation()
    after = before._replace(
        wanted=before.state.quaternion,
        view=before.view._replace(error=np.array([0.3, 0.0, 0.4]), arc_length=before.view.arc_length + 0.1),
    )
    worth = FollowingReward()
    step = Stepped(before, after, np.zeros(6), 0.5, 0.4, 0.5)
    assert worth(step) == pytest.approx(0.5 * ((0.5 + 0.5 * 0.5) * 1.0 * 0.5 - 0.1 * 0.5))
    at_point = worth(step._replace(speed=0.0, effort=0.0))
    assert at_point == pytest.approx(0.25)


@pytest.mark.flight
def test_a_spring_and_a_damper_earn_more_than_doing_nothing():
    env = gymnasium.make(HOLD).unwrapped
    idle = sum(row[-1] for row in flown(env, 1, np.zeros(6))[0][1:])
    seen, _ = env.reset(seed=1)
    at, earned, over = env.layout.at, 0.0, False
    while not over:
        error, turn = seen[at("ways")][:3], seen[at("attitude")]
        force = 100.0 * error - 150.0 * seen[at("velocity")]
        torque = 20.0 * turn - 15.0 * seen[at("rates")]
        seen, reward, terminated, truncated, _ = env.step(env.scale.share(np.concatenate([force, torque])))
        earned, over = earned + reward, terminated or truncated
    assert earned > 15.0
    assert earned > 3.0 * idle


@pytest.mark.flight
@pytest.mark.parametrize("processes", [False, True])
def test_environments_side_by_side_are_those_alone(processes):
    many = make_vec(HOVER, 2, processes=processes, overrides=SHORT, randomise=RANDOM, ticks=10)
    try:
        first, _ = many.reset(seed=3)
        rows = [many.step(np.full((2, 6), 0.1)) for _ in range(4)]
        for i in range(2):
            alone = FlightEnv(HOVER, SHORT, randomise=RANDOM, ticks=10)
            assert alone.reset(seed=3 + i)[0].tobytes() == first[i].tobytes()
            for seen, rewards, *_ in rows:
                each, reward, *_ = alone.step(np.full(6, 0.1))
                assert each.tobytes() == seen[i].tobytes()
                assert reward == rewards[i]
    finally:
        many.close()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"action": "thrust"}, "no action 'thrust'; there are wrench, forces, commands"),
        ({"ticks": 0}, "ticks takes"),
        ({"randomise": {"hull": {}}}, "no 'hull'; there are scenario, model"),
        ({"randomise": {"model": {"hull:weight": [1, 2]}}}, "the nearest hull:inertia, hull:volume, hull:mass"),
        ({"randomise": {"model": {"hul:mass": [1, 2]}}}, "the nearest hull:mass, hull:added_mass"),
        ({"randomise": {"model": {"hull:added_mass": [2, 1]}}}, "in order"),
        ({"randomise": {"model": {"hull:added_mass": [[1, 1], [2, 2]]}}}, "takes 1 factor or 6"),
        ({"randomise": {"model": {"hull:mass": [-1, 1]}}}, "at its ends it is -125; a mass"),
        ({"randomise": {"model": {"hull:thruster_lag": [0, 1]}}}, "a time constant"),
        ({"randomise": {"model": {"hull:inertia": [[0.9, 0.8, 0.7], [1, 1.1, 2]]}}}, "principal moments"),
        ({"randomise": {"thrusters": [0.5, 1.5]}}, "between 0 and 1"),
        ({"randomise": {"faults": {"most": 9}}}, "takes 0 to 8"),
        ({"randomise": {"faults": {"states": ["broken"]}}}, "some of dead, weak, stuck"),
        ({"randomise": {"faults": {"at_s": [0, 100]}}}, "between 0 and 1"),
        ({"randomise": {"scenario": {"current_m_s": 0.2}}}, "takes [lowest, highest]"),
        ({"randomise": {"scenario": {"current_m_s": {"one_of": []}}}}, "at least one"),
        ({"randomise": [1]}, "takes a mapping"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(arguments, said):
    with pytest.raises(FlightError) as refused:
        FlightEnv(HOVER, SHORT, **arguments)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_cannot_be_flown_or_done_is_refused():
    with pytest.raises(ScenarioError, match=r"guidance\.speed_m_s"):
        FlightEnv(HOVER, SHORT, randomise={"scenario": {"guidance.speed_m_s": [-2.0, -1.0]}})
    env = FlightEnv(HOVER, SHORT)
    env.reset(seed=0)
    with pytest.raises(FlightError, match=r"shape \(3,\)"):
        env.step(np.zeros(3))
    with pytest.raises(FlightError, match="finite"):
        env.step(np.full(6, np.nan))
    with pytest.raises(FlightError, match="no option 'depth'"):
        env.reset(options={"depth": 3.0})
    with pytest.raises(FlightError, match="count"):
        make_vec(HOVER, 0)


def test_the_package_does_without_gymnasium():
    code = (
        "import sys; sys.modules['gymnasium'] = None; import cube_sim; cube_sim.Flight\n"
        "try:\n    import cube_sim.gym\nexcept ImportError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install 'cube-sim[gym]'" in done.stdout


def test_thrusters_of_different_lags_get_a_factor_each():
    given = {"parameters": {"T3:thruster_lag": [0.1]}, **SHORT}
    env = FlightEnv(HOVER, given, randomise={"model": {"hull:thruster_lag": [2.0, 2.0]}})
    env.reset(seed=1)
    lags = env.flight.mission.model.actuator_dynprm[:, 0]
    assert lags.tolist() == [0.04, 0.04, 0.2, *[0.04] * 5]


@pytest.mark.flight
def test_resets_of_one_compiled_model_are_those_that_compile_each(monkeypatch):
    compiled, whole = [], CompiledOnce.of
    monkeypatch.setattr(CompiledOnce, "of", lambda *given: compiled.append(given) or whole(*given))
    env = FlightEnv(HELIX, SHORT, randomise=RANDOM)
    each = FlightEnv(HELIX, SHORT, randomise=RANDOM)
    each._loaded = replace(each._loaded, shared=None)
    for k, seed in enumerate((1, 2, 1)):
        count = len(compiled)
        together, ended = flown(env, seed)
        assert (len(compiled) > count) == (k == 0)  # with room for what is drawn, once
        apart, ended_too = flown(each, seed)
        assert len(compiled) > count
        assert same(together, apart)
        assert ended["ended"] == ended_too["ended"]
