"""What a run says of demands that were not made: when, how much, where to, why, and whether the path suffered."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from support.places import SCENARIOS

from cube_sim.allocation import Status
from cube_sim.flight.off_path_log import OffPathLog
from cube_sim.flight.rows import rows_for
from cube_sim.flight.shortfall import Thrust, listed
from cube_sim.flight.taken_over import Watches
from cube_sim.flight.unattainable_log import UnattainableLog
from cube_sim.mission import prepare
from cube_sim.mission.pace_log import PaceLog
from cube_sim.recording.channels import channel_table
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import load

DT = 0.02
A = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.5]])
THRUST = Thrust(("bow", "side"), A, np.array([[-20.0, -2.0, 2.0, 20.0]] * 2), 0.5)
CHANNELS = channel_table(THRUST.names, 2)


def flown(ticks: int):
    """Rows of a flight whose demands are made, with nothing asked for."""
    rows = rows_for(CHANNELS, ticks)
    for table in (rows.allocation, rows.wrench, rows.thrusters, rows.path_error):
        table[:] = 0.0
    rows.health[:] = 1.0
    return rows


def missed(rows, ticks, demanded, force, status=Status.CLOSEST):
    made = A @ force
    for k in ticks:
        rows.allocation[k, 1], rows.allocation[k, 3] = np.linalg.norm(np.subtract(demanded, made)), status
        rows.wrench[k, 1:7], rows.wrench[k, 7:13], rows.thrusters[k, 1:3] = demanded, made, force


def told(rows) -> list[tuple[float, str, str]]:
    store = SignalStore(CHANNELS)
    log = UnattainableLog(store, THRUST)
    for k in range(len(rows.allocation)):
        log.note(k * DT, rows, k, 1.0)
    log.finish(len(rows.allocation) * DT)
    return [(line.t, line.level, line.text) for line in store.lines]


@pytest.mark.parametrize("seed", range(12))
def test_many_ticks_at_once_say_what_they_say_one_by_one(seed):
    """Runs of statuses, beliefs and paces of all lengths, taken in by stretches of rows of all lengths."""
    rng = np.random.default_rng(seed)
    kinds = Status.EXACT, Status.CLOSEST, Status.UNPROVEN_CLOSEST, Status.INVALID_WRENCH
    n, typical = 1500, [3, 40, 400][seed % 3]
    rows, k = flown(n), 0
    pace = np.ones(n)
    while k < n:
        end = min(n, k + 1 + int(rng.exponential(typical)))
        status = rng.choice(kinds, p=[0.2, 0.5, 0.2, 0.1])
        for i in range(k, end):
            missed(rows, [i], rng.normal(size=6), rng.normal(size=2), status)
        rows.health[k:end, 3] = rng.choice([1.0, 0.5])
        rows.path_error[k:end] = rng.normal(size=rows.path_error[k:end].shape)
        pace[k:end] = rng.choice([1.0, 0.5])
        k = end
    times, ratio = [i * DT for i in range(n)], rng.uniform(0.5, 1.0, n)
    said = []
    for at_once in (False, True):
        store = SignalStore(CHANNELS)
        watches = Watches(UnattainableLog(store, THRUST), PaceLog(store, 0.3), OffPathLog(store), surface=None)
        cuts = [0, 0, *sorted(rng.integers(1, n, 5).tolist()), n] if at_once else []
        for a, b in pairwise(cuts):
            part = type(rows)(*(table[a:b] for table in rows))
            watches.note_all(times[a:b], part, ratio[a:b], pace[a:b])
        for i in () if at_once else range(n):
            watches.note(times[i], rows, i, ratio[i], pace[i])
        watches.unattainable.finish(n * DT)
        said.append([(line.t, line.level, line.text) for line in store.lines])
    assert said[0] == said[1]
    assert said[0]


def test_nothing_is_said_of_what_is_made_or_of_a_moment():
    rows = flown(200)
    assert UnattainableLog(SignalStore(CHANNELS), THRUST).quiet(rows)
    missed(rows, range(20, 60), [30.0, 0, 0, 0, 0, 0], [20.0, 0.0])
    assert not UnattainableLog(SignalStore(CHANNELS), THRUST).quiet(rows)
    assert told(rows) == []


def test_a_stretch_is_one_line_when_it_is_over_with_the_worst_of_it():
    rows = flown(300)
    missed(rows, range(50, 150), [22.0, 0, 0, 0, 0, 0], [20.0, 0.0])
    missed(rows, range(100, 101), [-50.0, 0, 0, 0, 0, 8.0], [-20.0, 0.0])
    missed(rows, range(120, 140), [0.0] * 6, [0.0, 0.0], Status.EXACT)  # less than a second: the same stretch
    ((t, level, text),) = told(rows)
    assert (t, level) == (pytest.approx(149 * DT + 1.0), "INFO")
    assert text == (
        "the demanded wrench was out of reach, and the closest attainable one made from 1.00 s to 2.98 s; at worst, at "
        "2.00 s, 30 of 50 N backward missing, 8 of 8 N m of yaw missing: bow at its limit; the vehicle came no further "
        "off its target meanwhile"
    )


def test_of_one_that_comes_and_goes_it_is_said_for_how_much_of_the_time():
    """It is one line, as what lies between is less than a second."""
    rows = flown(1000)
    for start in range(100, 701, 30):
        missed(rows, range(start, start + 3), [1.0, 0, 0, 0, 0, 0], [0.0, 0.0])
    ((_, _, text),) = told(rows)
    assert " made for 10 % of the time from 2.00 s to 14.04 s; at worst, at 2.00 s, " in text


def test_it_is_a_warning_where_the_vehicle_leaves_its_target():
    rows = flown(300)
    missed(rows, range(50, 150), [22.0, 0, 0, 0, 0, 0], [20.0, 0.0])
    rows.path_error[:, 1] = 0.3
    rows.path_error[80:170, 4] = 0.4  # sqrt(0.3^2 + 0.4^2) - 0.3
    ((_, level, text),) = told(rows)
    assert level == "WARNING"
    assert text.endswith("; the vehicle came 0.2 m further off its target meanwhile")


@pytest.mark.parametrize(
    ("demanded", "force", "words"),
    [
        ([1.0, 0, 0, 0, 0, 0], [0.0, 0.0], "1 of 1 N forward missing: less than the thrusters' dead zones leave"),
        ([1.0, 0, 0, 0, 0, 0], [2.0, 0.0], "1 N forward too much: less than the thrusters' dead zones leave"),
        ([0, 0, -3.0, 0, 0, 0], [0.0, 0.0], "3 of 3 N down missing: no thruster that works makes any of it"),
        ([0, 0, 0, 0, 0, 2900.0], [0.0, 20.0], "all but 10 of 2900 N m of yaw missing: side at its limit"),
        ([0, 0, 0, 0, 0, 160.0], [0.0, 20.0], "150 of 160 N m of yaw missing: side at its limit"),
        ([40.0, 40.0, 0, 0, 0, 20.0], [20.0, 20.0], "bow and side at their limits"),
        ([0, -1.0, 0, 0, 0, 0.0], [0.0, -2.0], "1 N to starboard too much, 1 N m of yaw too much"),
    ],
)
def test_where_it_is_missing_and_why(demanded, force, words):
    rows = flown(100)
    missed(rows, range(100), demanded, force)
    ((t, _, text),) = told(rows)
    assert t == pytest.approx(100 * DT)  # the flight ended amid it
    assert words in text


@pytest.mark.parametrize(
    ("demanded", "wanted", "words"),
    [
        ([0, 0, -3.0, 0, 0, 0], -0.2, "3 of 3 N down missing: stern at its limit"),
        (
            [0, 0, -3.0, 0, 0, 0],
            0.2,
            "3 of 3 N down missing: only fins make any of it, as much as their servos",
        ),
        ([0, 0, 0, 5.0, 0, 0], 0.1, "5 of 5 N m of roll missing: no thruster that works and no fin makes any of it"),
    ],
)
def test_fins_are_told_like_thrusters(demanded, wanted, words):
    per_newton = np.array([[0.0, 0.0, 1.0, 0.0, 0.9, 0.0]]).T
    thrust = THRUST._replace(fins=("stern",), per_newton=per_newton, travel=np.array([[-0.2, 0.3]]))
    channels = channel_table(THRUST.names, 2, fins=thrust.fins)
    rows, store = rows_for(channels, 100), SignalStore(channels)
    for table in (rows.allocation, rows.wrench, rows.thrusters, rows.path_error, rows.fins):
        table[:] = 0.0
    rows.health[:] = 1.0
    missed(rows, range(100), demanded, [0.0, 0.0])
    rows.fins[:, 1] = wanted
    log = UnattainableLog(store, thrust)
    for k in range(100):
        log.note(k * DT, rows, k, 1.0)
    log.finish(100 * DT)
    assert words in store.lines[0].text


def test_a_dead_thruster_is_at_no_limit():
    rows = flown(100)
    missed(rows, range(100), [30.0, 0, 0, 0, 0, 0], [0.0, 0.0])
    rows.health[:, 1 + 2] = 0.0  # what is believed of the first
    ((_, _, text),) = told(rows)
    assert "30 of 30 N forward missing: no thruster that works makes any of it" in text


def test_what_dead_zones_swallowed_before_is_told_apart_from_what_a_fault_leaves_out_of_reach():
    rows = flown(300)
    missed(rows, range(50, 150), [1.0, 0, 0, 0, 0, 0], [0.0, 0.0])
    missed(rows, range(150, 250), [30.0, 0, 0, 0, 0, 0], [0.0, 0.0])
    rows.health[150:, 1 + 2] = 0.0  # the first is believed dead from 3 s on
    (first, _, swallowed), (_, _, lost) = told(rows)
    assert first == pytest.approx(150 * DT)
    assert "from 1.00 s to 2.98 s" in swallowed
    assert "less than the thrusters' dead zones leave" in swallowed
    assert "from 3.00 s to 4.98 s" in lost
    assert "30 of 30 N forward missing: no thruster that works makes any of it" in lost


def test_a_demand_that_is_none_is_an_error_at_once_and_once():
    rows = flown(200)
    rows.allocation[10:20, 3] = rows.allocation[30:40, 3] = Status.INVALID_WRENCH
    assert told(rows) == [
        (pytest.approx(10 * DT), "ERROR", "the demanded wrench is not finite: it counts as zero"),
        (pytest.approx(89 * DT), "INFO", "the demanded wrench is finite again"),
    ]


def test_names_in_a_sentence():
    assert [listed(names) for names in (["a"], ["a", "b"], ["a", "b", "c"])] == ["a", "a and b", "a, b and c"]


def test_a_run_tells_of_the_fins_of_its_vehicle():
    mission = prepare(load(SCENARIOS / "remus100_line.yaml"))
    watches = Watches.of(mission, SignalStore(channel_table(mission.vehicle.thrusters.names, 2)))
    thrust, fins = watches.unattainable._thrust, mission.vehicle.fins
    assert fins is not None
    assert thrust.fins == ("stern_planes", "rudder")
    np.testing.assert_array_equal(thrust.travel, fins.travel)
    np.testing.assert_allclose(np.linalg.norm(thrust.per_newton[:3], axis=0), 1.0)


def test_no_more_is_missing_than_was_asked_for():
    """What is made the other way is told beside: 46 N m asked, -2 N m made were "48 of 46 N m missing"."""
    rows = flown(100)
    missed(rows, range(100), [0.0, 0.0, 0.0, 0.0, 0.0, 46.0], [0.0, -4.0])
    ((_, _, text),) = told(rows)
    assert "all 46 N m of yaw missing and 2 N m made the other way" in text
    rows = flown(100)
    missed(rows, range(100), [0.0, 0.0, 0.0, 0.0, 0.0, 46.0], [0.0, -1e-9])
    assert "46 of 46 N m of yaw missing" in told(rows)[0][2]
