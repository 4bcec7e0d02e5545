"""What comes amid a tick: a flight stands at a whole one afterwards, or says that it cannot go on."""

from __future__ import annotations

import copy
import pickle
import signal

import numpy as np
import pytest
from support.own_code import PID, scenario_with
from support.places import HELIX

from cube_sim.errors import FlightError
from cube_sim.flight import Flight, loop
from cube_sim.guidance.helix import Helix

LOST = {"kind": "thrusters", "at_s": 0.3, "thrusters": ["T1"], "state": "dead"}
SHORT = {"duration_s": 1.0, "checks": [{"kind": "allowed_forces"}], "events": [LOST]}
"""What Python has something to do in."""
WAYS = {"stepped": lambda flight: flight.step(), "flown": lambda flight: flight.fly(50 - flight.tick)}
PLACES = "begin_ticks", "take_over", "tick", "write_power", "respond_to_faults"
"""Functions of the loop, amid a tick."""


@pytest.fixture
def ctrl_c():
    """Ctrl-C as Python has it, whatever the runner of the tests does with it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield signal.SIGINT
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def alarm():
    """A signal of somebody else's, whose handler raises."""

    def raises(*_):
        raise TimeoutError("time is up")

    before = signal.signal(signal.SIGUSR1, raises)
    yield signal.SIGUSR1
    signal.signal(signal.SIGUSR1, before)


def interrupting(monkeypatch, place, number, at, times=1):
    """Let a signal come after a function of the loop has been called so often."""
    function, calls = getattr(loop, place), []

    def interrupted(*given, **named):
        answer = function(*given, **named)
        calls.append(1)
        if len(calls) == at:
            for _ in range(times):
                signal.raise_signal(number)
        return answer

    monkeypatch.setattr(loop, place, interrupted)


def to_its_end(flight, way):
    """Fly on, whatever is raised; what was."""
    raised = []
    while not flight.over and len(raised) < 3:
        try:
            WAYS[way](flight)
        except (KeyboardInterrupt, TimeoutError, FlightError) as error:
            raised.append(error)
    return raised


def assert_same(one, other):
    assert {name: rows.tobytes() for name, rows in one.items()} == {
        name: rows.tobytes() for name, rows in other.items()
    }


def places_of(way):
    return PLACES if way == "flown" else PLACES[2:]


@pytest.mark.flight
@pytest.mark.parametrize(("way", "place"), [(way, place) for way in WAYS for place in places_of(way)])
def test_ctrl_c_comes_after_a_whole_tick(monkeypatch, ctrl_c, way, place):
    whole = Flight(HELIX, SHORT)
    whole.fly(50)
    cut = Flight(HELIX, SHORT)
    interrupting(monkeypatch, place, ctrl_c, 1)
    raised = to_its_end(cut, way)
    assert [type(error) for error in raised] == [KeyboardInterrupt]
    assert_same(whole.signals, cut.signals)
    assert [line.text for line in whole.log] == [line.text for line in cut.log]


@pytest.mark.flight
@pytest.mark.parametrize("way", WAYS)
def test_what_is_raised_amid_a_tick_leaves_a_flight_that_says_so(monkeypatch, alarm, way):
    whole = Flight(HELIX, SHORT)
    whole.fly(50)
    cut = Flight(HELIX, SHORT)
    cut.step()
    early = cut.snapshot()
    with monkeypatch.context() as patch:
        interrupting(patch, "tick", alarm, 1)
        cut._python_until = 5  # the next ticks are flown in Python
        with pytest.raises(TimeoutError):
            WAYS[way](cut)
    for use in (cut.step, lambda: cut.fly(1), cut.snapshot, cut.observation, lambda: copy.copy(cut)):
        with pytest.raises(FlightError, match="interrupted amid a tick; reset it, or restore a snapshot"):
            use()
    assert cut.restore(early).time_s == 0.02
    cut.fly(49)
    rows = whole.signals["pose.position"]
    assert rows[rows[:, 0] > 0.01].tobytes() == cut.signals["pose.position"].tobytes()
    cut.reset()
    cut.fly(50)
    assert_same(whole.signals, cut.signals)


@pytest.mark.flight
def test_a_second_ctrl_c_does_not_wait(tmp_path, ctrl_c):
    """A law of one's own that never answers can be left, by asking twice."""
    endless = "import signal\nfrom math import nan\ndef make(setup):\n    def law(aim):\n        if aim.time > 0.1:\n"
    endless += "            signal.raise_signal(2)\n            signal.raise_signal(2)\n            while True:\n"
    endless += "                pass\n        return [0.0] * 6\n    return law\n"
    flight = Flight(scenario_with(tmp_path, endless, control="{law: {python: 'own.py:make'}}"))
    with pytest.raises(KeyboardInterrupt):
        flight.fly(20)
    with pytest.raises(FlightError, match="interrupted amid a tick"):
        flight.fly(20)
    assert flight.reset().time_s == 0.0


@pytest.mark.flight
@pytest.mark.parametrize("copied", [copy.deepcopy, copy.copy])
@pytest.mark.parametrize("own", [False, True])
def test_a_copy_is_a_flight_for_itself(tmp_path, copied, own):
    law = {"control": "{law: {python: 'own.py:pid'}}"} if own else {"navigation": "{}"}
    path = scenario_with(tmp_path, PID, **law)
    whole, first = Flight(path), Flight(path)
    whole.fly(25)
    first.fly(10)
    second = copied(first)
    second.fly(15)
    assert first.tick == 10
    first.fly(15)
    for flight in (first, second):
        assert_same(whole.signals, flight.signals)
        assert flight.log == whole.log


@pytest.mark.flight
def test_a_flight_is_not_pickled():
    with pytest.raises(FlightError, match="pickle its snapshot"):
        pickle.dumps(Flight(HELIX, SHORT))


@pytest.mark.flight
def test_a_snapshot_is_taken_up_by_the_same_model_alone(tmp_path):
    """Not by one of the same name with another mass, nor along a path of the same words with another radius."""
    path = scenario_with(tmp_path, "")
    model = tmp_path / "hull.xml"
    text = (HELIX.parent.parent / "models" / "cube.xml").read_text()
    model.write_text(text)
    flight = Flight(path, {"model": str(model)})
    flight.fly(5)
    middle = flight.snapshot()
    assert Flight(path, {"model": str(model)}).restore(middle).time_s == 0.1
    model.write_text(text.replace('timestep="0.01"', 'timestep="0.01" density="0"').replace("<custom>", "<custom> "))
    with pytest.raises(FlightError, match=r"another scenario: not the same model/hull\.xml$"):
        Flight(path, {"model": str(model)}).restore(middle)
    narrow, wide = (Flight(path, path=Helix(np.array([0.0, 0.0, -5.0]), r, 5.0, 1.0)) for r in (3.0, 4.0))
    with pytest.raises(FlightError, match=r"another scenario: not the same path$"):
        wide.restore(narrow.snapshot())
    with pytest.raises(FlightError, match="takes a Snapshot"):
        flight.restore(b"x")


@pytest.mark.flight
def test_what_makes_no_sense_leaves_a_flight_where_it_is():
    flight = Flight(HELIX, {**SHORT, "navigation": {}})
    state = flight.fly(3).state
    for seed in (-1, 1.5, "a", 2**63):
        with pytest.raises(FlightError, match=r"seed is .*; it takes a whole number from 0 to 2"):
            flight.reset(seed=seed)
    for wrong in (state._replace(position=[0.0, 0.0]), 3, state._replace(rates="fast")):
        with pytest.raises(FlightError, match="state"):
            flight.reset(state=wrong)
    for ticks in ("3", None, [1]):
        with pytest.raises(FlightError, match="fly whole ticks"):
            flight.fly(ticks)
    assert flight.tick == 3


@pytest.mark.flight
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("wrench", [np.full(6, 1e300), ["1"] * 6, np.zeros(6, complex)])
def test_a_wrench_out_of_this_world_is_refused(wrench):
    flight = Flight(HELIX, SHORT)
    with pytest.raises(FlightError, match="wrench"):
        flight.step(wrench=wrench)
    assert not flight.step(wrench=np.full(6, 1e30)).ended
