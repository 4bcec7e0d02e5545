"""The compiled stage is the readable one: run by the interpreter, its source gives the same estimates and outcomes."""

from __future__ import annotations

import numpy as np
import pytest
from support.navigation_motion import AIDS, DEG, DT, GRAVITY, IMU, INITIAL, navigate, truths, tumbling, weaving
from support.plain_callbacks import plain

from cube_sim.navigation import normals
from cube_sim.navigation.depth import Depth
from cube_sim.navigation.dvl import Dvl
from cube_sim.navigation.estimating import ERROR, ESTIMATE, NavigationMemory, estimate
from cube_sim.navigation.heading import Heading
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import InitialErrors, Navigator
from cube_sim.navigation.normals import DrawnAhead
from cube_sim.navigation.own_aid import OwnAid
from cube_sim.navigation.position import PositionFix
from cube_sim.navigation.reading import READING, ReadingOutcome
from cube_sim.navigation.sampling import Sampling
from cube_sim.navigation.streams import stream
from cube_sim.spatial import quaternion_from_euler, rotation_about, rotation_from_quaternion

DVL = Dvl(Sampling(12.5, 0.04), 0.01, 0.002, 0.005, (0.1, 0.0, -0.2))
DEPTH = Depth(Sampling(12.5, 0.06), 0.01, 0.05)
HEADING = Heading(Sampling(10.0, 0.1), 0.5 * DEG, 2.0 * DEG)
FIX = PositionFix(Sampling(5.0, 0.18), 0.5)
OWN = OwnAid("own", Sampling(5.0, 0.08), 2, 0.1, 0.2, False, lambda motion: motion.position[:2] * motion.velocity[:2])
EACH = DVL, DEPTH, HEADING, FIX, OWN
SETS = {"none": (), "all": EACH, **{aid.name: (aid,) for aid in EACH}}


def readable(memory):
    """The same memory, fields of its records attributes for the interpreter, too."""
    if isinstance(memory, tuple):
        return type(memory)(*(readable(part) for part in memory))
    return memory.view(np.recarray) if memory.dtype.names else memory


def copied(memory):
    return type(memory)(*(copied(part) for part in memory)) if isinstance(memory, tuple) else memory.copy()


def assert_near(fast, slow):
    if isinstance(fast, tuple):
        for one, other in zip(fast, slow, strict=True):
            assert_near(one, other)
    elif fast.dtype.names:
        for name in fast.dtype.names:
            assert_near(fast[name], slow[name])
    else:
        np.testing.assert_allclose(fast, slow, rtol=1e-8, atol=1e-11)


def both(motions, aids, initial=INITIAL, seed=3, leap=None):
    """Fly the compiled and the interpreted stage beside each other; the outcomes by sensor, and those of NIS zero.

    Of a leap, the number of the first tick after it, the inertial unit feels nothing.
    """
    navigator = Navigator(IMU, aids, initial, motions[0], seed, GRAVITY, DT)
    parameters, memory = navigator.stage(len(motions))
    slow = copied(memory)
    interpreted = plain("cube_sim.navigation.estimating").estimate
    assert not hasattr(interpreted, "py_func")
    told = [[np.zeros(1, ESTIMATE), np.zeros(1, ERROR), np.zeros(len(aids), READING)] for _ in range(2)]
    outcomes: list[set] = [set() for _ in aids]
    for tick, true in enumerate(motions):
        for unit in (memory.imu, slow.imu) if tick == leap else ():
            unit["velocity"], unit["rotation"] = true.velocity, true.rotation
        count = estimate(parameters, memory, *true, *told[0])
        assert count == interpreted(readable(parameters), readable(slow), *true, *map(readable, told[1]))
        for fast, other in zip(told[0][:2], told[1][:2], strict=True):
            assert_near(fast, other)
        assert_near(told[0][2][:count], told[1][2][:count])
        for reading in told[0][2][:count]:
            outcomes[reading["aid"]].add((int(reading["outcome"]), reading["nis"] == 0.0))
    assert_near(memory, slow)
    assert memory.filter.tick[0] == len(motions) - 1
    return outcomes


@pytest.mark.parametrize("aids", SETS.values(), ids=SETS)
@pytest.mark.parametrize("motion", [weaving, tumbling])
def test_every_set_of_sensors_with_delays(motion, aids):
    outcomes = both(truths(motion, 1.2), aids)
    assert all(outcome == {(ReadingOutcome.FUSED, False)} for outcome in outcomes)


@pytest.mark.parametrize(
    "aids", [each for each in SETS.values() if each], ids=[name for name in SETS if name != "none"]
)
def test_a_leap_that_no_inertial_unit_feels_is_rejected_and_believed_in_the_end(aids):
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), 1.0)

    def leaping(t):
        true = weaving(t)
        if t < 0.4:
            return true
        p, v, R, w = true
        return Motion(p + np.array([20.0, 0.0, 5.0]), v + np.array([2.0, 0.0, 0.0]), turn @ R, w)

    outcomes = both(truths(leaping, 1.6), aids, leap=20)
    assert {which for outcome in outcomes for which, _ in outcome} == set(ReadingOutcome)


def test_a_compass_that_reads_where_the_estimate_is_too_steep_is_neither_fused_nor_held_against_it():
    """The nose 75.3 degrees up, its heading read up to 75.5; the first estimate is off by more."""
    true = weaving(0.0)
    R = rotation_from_quaternion(quaternion_from_euler(0.0, -75.3 * DEG, 0.4))
    still = true._replace(rotation=R, rates=np.zeros(3))
    seen = [both([still] * 12, [HEADING], InitialErrors(0.5, 0.05, 2.0 * DEG, 3.0 * DEG), seed)[0] for seed in range(4)]
    assert {(ReadingOutcome.REJECTED, True)} in seen
    assert {(ReadingOutcome.FUSED, False)} in seen


def test_it_is_compiled_once_for_all_sets():
    for aids in SETS.values():
        navigate(truths(weaving, 0.1), aids=aids)
    assert len(estimate.forms) == 1


@pytest.mark.parametrize("ahead", [1, 7, 400])
def test_how_far_ahead_numbers_are_drawn_changes_nothing(ahead, monkeypatch):
    motions = truths(weaving, 3.0)
    before = navigate(motions, 4)
    monkeypatch.setattr(normals, "TICKS_AHEAD", ahead)
    for one, other in zip(before, navigate(motions, 4), strict=True):
        assert one.error.tobytes() == other.error.tobytes()


def test_numbers_drawn_ahead_are_those_of_the_streams():
    rng, names = np.random.default_rng(1), ("imu", "dvl", "depth")
    drawn = DrawnAhead([stream(5, name) for name in names])
    expected, taken = [stream(5, name).standard_normal(12 * 60 * 170) for name in names], [0, 0, 0]
    for _ in range(60):
        ticks = int(rng.choice([1, 20, 49, 170]))
        drawn.reserve(ticks)
        values, used = drawn.normals
        for row, most in enumerate((12, 3, 1)):
            count = 12 * ticks if row == 0 else int(rng.integers(0, most * ticks + 1))
            first = int(used[row])
            assert first + count <= values.shape[1]
            np.testing.assert_array_equal(
                values[row, first : first + count], expected[row][taken[row] : taken[row] + count]
            )
            used[row] += count
            taken[row] += count


def test_a_stage_for_a_second_is_the_same_memory():
    """What a loop of its own goes on with is what `update` goes on with."""
    motions = truths(weaving, 1.0)
    one, other = (Navigator(IMU, AIDS, INITIAL, motions[0], 2, GRAVITY, DT) for _ in range(2))
    for true in motions:
        one.update(true)
    parameters, memory = other.stage(30)
    assert isinstance(memory, NavigationMemory)
    into = np.zeros(1, ESTIMATE), np.zeros(1, ERROR), np.zeros(len(AIDS), READING)
    for true in motions[:30]:
        estimate(parameters, memory, *true, *into)
    for true in motions[30:]:
        other.update(true)
    assert one.answer.tobytes() == other.answer.tobytes()
    assert one.filter.P.tobytes() == other.filter.P.tobytes()
