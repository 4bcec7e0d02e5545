"""A flight that is stepped: the same as a run, resumed to the bit, and steered from outside."""

from __future__ import annotations

import pickle
import signal
import threading

import numpy as np
import pytest
from support.places import HELIX, SCENARIO_FILES, SCENARIOS

import cube_sim
from cube_sim.errors import FlightError, ScenarioError
from cube_sim.flight import Flight
from cube_sim.spatial import State

SHORT = {"duration_s": 4.0, "checks": [{"kind": "allowed_forces"}]}
LOST = {"kind": "thrusters", "at_s": 1.0, "thrusters": ["T1"], "state": "dead"}


def flown(flight, ticks=10**9, **action):
    """Step so often, or to the end; the last observation."""
    seen = None
    while not flight.over and ticks > 0:
        seen, ticks = flight.step(**action), ticks - 1
    return seen


def assert_same(one, other, since=-1.0):
    """All signals of two flights are the same bits from a time on."""
    assert set(one) == set(other)
    for name, rows in one.items():
        a, b = rows[rows[:, 0] > since], other[name][other[name][:, 0] > since]
        assert a.tobytes() == b.tobytes(), name


@pytest.mark.flight
def test_a_stepped_flight_is_the_run(tmp_path):
    run = cube_sim.run(HELIX, SHORT, tmp_path / "run")
    flight = Flight(HELIX, SHORT)
    flown(flight)
    end = 4.0 - 1e-9  # a run records the state at its end as well
    for name, rows in flight.signals.items():
        recorded = run.signals[name]
        assert rows.tobytes() == recorded[recorded[:, 0] < end].tobytes(), name


@pytest.mark.flight
@pytest.mark.parametrize("path", SCENARIO_FILES, ids=lambda path: path.stem)
def test_a_snapshot_is_taken_up_to_the_bit(path):
    """By the same flight later, and by another one from the pickled bytes."""
    settings = {"duration_s": 3.0, "checks": SHORT["checks"], "events": []}
    flight = Flight(path, settings)
    flown(flight, 60)
    middle = flight.snapshot()
    flown(flight)
    other = Flight(path, settings)
    other.restore(pickle.loads(pickle.dumps(middle)))
    flown(other)
    assert_same(other.signals, flight.signals, since=59.5 * flight.mission.scenario.control_period_s)
    first = flight.signals
    flight.reset()
    flown(flight)
    assert_same(flight.signals, first)


@pytest.mark.flight
def test_a_snapshot_amid_a_fault_is_taken_up_to_the_bit():
    settings = {**SHORT, "events": [LOST], "duration_s": 6.0, "current_m_s": [0.0, 0.3, 0.1]}
    flight = Flight(SCENARIOS / "cube_lose_one.yaml", settings)
    while flight.mission.allocator.health.efficiency.all():
        flight.step()
    flown(flight, 7)
    middle = flight.snapshot()
    flown(flight)
    other = Flight(SCENARIOS / "cube_lose_one.yaml", settings)
    other.restore(middle)
    flown(other)
    assert_same(other.signals, flight.signals, since=other.signals["pose.position"][0, 0] - 1e-9)


@pytest.mark.flight
def test_another_seed_gives_another_flight_and_the_same_seed_the_same():
    flight = Flight(SCENARIOS / "cube_navigated.yaml", {"duration_s": 1.0, "checks": SHORT["checks"]})
    flights = []
    for seed in (None, 7, 7, 8):
        flight.reset(seed=seed)
        flown(flight)
        flights.append(flight.signals)
    assert_same(flights[1], flights[2])
    estimates = [signals["navigation.position"][:, 1:] for signals in flights]
    for one, other in ((0, 1), (1, 3), (0, 3)):
        assert not np.array_equal(estimates[one], estimates[other])
    seeded = Flight(SCENARIOS / "cube_navigated.yaml", {"duration_s": 1.0, "checks": SHORT["checks"], "seed": 7})
    flown(seeded)
    assert_same(seeded.signals, flights[1])


def test_what_is_given_is_flown():
    flight = Flight(HELIX, SHORT)
    m = len(flight.mission.vehicle.thrusters.names)
    pushed = flight.step(wrench=[30.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(pushed.wrench, [30.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-9)
    asked = np.linspace(10.0, 24.0, m)
    seen = flight.step(forces=asked)
    np.testing.assert_allclose(seen.wrench, flight.mission.allocator.A @ asked, atol=1e-9)
    flown(flight, 100, forces=asked)
    np.testing.assert_allclose(flight.observation().force, asked, rtol=0.02)
    before = flight.observation().time_s
    flown(flight, 60, commands=np.zeros(m))
    seen = flight.observation()
    np.testing.assert_allclose(seen.force, 0.0)
    assert seen.time_s == pytest.approx(before + 60 * flight.mission.scenario.control_period_s)


def test_the_attitude_wanted_is_the_recorded_one_and_foreseen_at_the_beginning():
    flight = Flight(HELIX, SHORT)
    seen = [flight.observation(), *(flight.step() for _ in range(5))]
    recorded = flight.signals["reference.quaternion"][:, 1:]
    assert not np.allclose(seen[0].wanted, seen[0].state.quaternion, atol=0.1)
    np.testing.assert_allclose(seen[0].wanted, recorded[0], atol=1e-12)
    np.testing.assert_array_equal([each.wanted for each in seen[1:]], recorded)


def test_a_flight_starts_from_any_state():
    flight = Flight(HELIX, SHORT)
    q = np.array([2.0, 0.0, 0.0, 2.0])
    seen = flight.reset(state=State(np.array([1.0, 2.0, -7.0]), q, np.eye(3), np.array([0.1, 0.0, 0.0]), np.zeros(3)))
    np.testing.assert_allclose(seen.state.position, [1.0, 2.0, -7.0])
    np.testing.assert_allclose(seen.state.rotation[:, 0], [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(seen.state.velocity, [0.1, 0.0, 0.0], atol=1e-12)
    assert seen.time_s == 0.0
    assert not seen.over


@pytest.mark.parametrize(
    ("action", "said"),
    [
        ({"wrench": [1.0]}, "shape (1,)"),
        ({"wrench": np.zeros((2, 6))}, "shape (2, 6)"),
        ({"wrench": [np.nan] * 6}, "finite"),
        ({"forces": np.zeros(6)}, "8 numbers"),
        ({"commands": "full ahead"}, "8 numbers"),
        ({"wrench": np.zeros(6), "forces": np.zeros(8)}, "not wrench and forces"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(action, said):
    flight = Flight(HELIX, SHORT)
    with pytest.raises(FlightError) as refused:
        flight.step(**action)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
    assert flight.tick == 0


def test_nothing_is_stepped_past_the_end_and_no_snapshot_of_another_scenario_is_taken_up():
    flight = Flight(HELIX, {**SHORT, "duration_s": 0.1})
    assert flown(flight).over
    with pytest.raises(FlightError, match="over"):
        flight.step()
    with pytest.raises(FlightError, match="another scenario"):
        Flight(HELIX, SHORT).restore(flight.snapshot())
    with pytest.raises(FlightError, match="finite"):
        flight.reset(state=State(np.full(3, np.nan), np.array([1.0, 0, 0, 0]), np.eye(3), np.zeros(3), np.zeros(3)))


def test_a_vehicle_that_leaves_the_numbers_ends_its_flight_with_the_reason():
    flight = Flight(HELIX, {**SHORT, "initial.velocity_m_s": [1e5, 0.0, 0.0]})
    seen = flight.step()
    assert seen.over
    assert "acceleration" in seen.ended


def test_a_scenario_need_not_be_a_file():
    flight = Flight(
        {
            "schema_version": 1,
            "name": "held",
            "model": HELIX.parents[1] / "models" / "cube.xml",
            "duration_s": 1.0,
            "path": {"type": "point", "position_m": np.array([0.0, 0.0, -5.0])},
            "initial": {"position_m": (0.0, 0.0, -5.0)},
            "guidance": {"speed_m_s": 0.2},
            "checks": [{"kind": "allowed_forces"}],
        }
    )
    assert np.linalg.norm(flown(flight).state.position - [0.0, 0.0, -5.0]) < 0.05
    with pytest.raises(ScenarioError, match="speed_m_s"):
        Flight({"schema_version": 1, "guidance": {"speed_m_s": -1.0}})
    with pytest.raises(ScenarioError, match="cannot be written out"):
        Flight({"schema_version": 1, "name": object()})


@pytest.mark.flight
def test_nothing_is_flown_beyond_the_end():
    flight = Flight(HELIX, {**SHORT, "duration_s": 0.5})
    flight.fly_to_its_end()
    rows = len(flight.signals["pose.position"])
    for go_on in (lambda: flight.fly(5), lambda: flight.fly_to_its_end(), flight.step):
        with pytest.raises(FlightError, match="over"):
            go_on()
    assert len(flight.signals["pose.position"]) == rows == 26


@pytest.mark.flight
def test_so_many_ticks_at_once_are_so_many_steps():
    fast, slow = Flight(HELIX, SHORT), Flight(HELIX, SHORT)
    for ticks in (1, 37, 60, 2):
        seen = fast.fly(ticks)
        step = [slow.step() for _ in range(ticks)][-1]
        assert seen.time_s == step.time_s
        assert seen.state.position.tobytes() == step.state.position.tobytes()
        assert seen.wrench.tobytes() == step.wrench.tobytes()
    assert_same(fast.signals, slow.signals)
    with pytest.raises(FlightError, match="at least one tick, not 0"):
        fast.fly(0)
    with pytest.raises(FlightError, match=r"at least one tick, not 2\.5"):
        fast.fly(2.5)
    assert fast.fly(10**6).over
    assert not fast.ended


@pytest.mark.flight
def test_an_interrupt_leaves_a_flight_that_goes_on_to_the_bit():
    whole, cut = Flight(HELIX, {**SHORT, "duration_s": 60.0}), Flight(HELIX, {**SHORT, "duration_s": 60.0})
    whole.fly_to_its_end()
    times = 0
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        while not cut.over:
            timer = threading.Timer(0.03, signal.raise_signal, [signal.SIGINT])
            timer.start()
            try:
                while not cut.over:
                    cut.fly(10**9)
            except KeyboardInterrupt:
                times += 1
            timer.join()
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGINT, before)
    assert times >= 1
    assert_same({name: rows[rows[:, 0] < 59.99] for name, rows in whole.signals.items()}, cut.signals)


@pytest.mark.flight
def test_no_answer_goes_unconfirmed_though_many_are_confirmed_together():
    """Three seconds, less than waits to be confirmed together; at 1 s another allocator takes over from the first."""
    events = [{"kind": "thrusters", "at_s": 1.0, "thrusters": ["T1"], "state": "dead"}]
    flight = Flight(HELIX, {"duration_s": 3.0, "checks": [{"kind": "allowed_forces"}], "events": events})
    first = flight.mission.allocator._allocator
    flight.fly_to_its_end()
    last = flight.mission.allocator._allocator
    assert last is not first
    confirmed = [allocator._effort.qps for allocator in (first, last)]
    assert min(confirmed) >= 40
    assert sum(confirmed) == 151
    assert [allocator._effort.disagreements for allocator in (first, last)] == [0, 0]
