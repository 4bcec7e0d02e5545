"""A control law of the user's own: flown, recorded, saved, and refused where it is none."""

from __future__ import annotations

import importlib.util
import json
import pickle
import re
import time
from functools import partial
from hashlib import sha256

import mujoco
import numpy as np
import pytest
from support.command_line import call
from support.flights import said
from support.own_code import PID, scenario_with
from support.places import HELIX, REPO

import cube_sim
from cube_sim.control.controller import Decision
from cube_sim.errors import FlightError, ScenarioError
from cube_sim.mission.own.code import source_file
from cube_sim.mission.own.given import loaded_with, options_of
from cube_sim.mission.own.law import rotation_between
from cube_sim.recording.mcap.reader import read_contents
from cube_sim.recording.reading import read_recording
from cube_sim.runs.replay import replay
from cube_sim.spatial import rotation_from_quaternion

LAW = "{law: {python: 'own.py:make'}}"
SHORT = {"duration_s": 2.0, "checks": [{"kind": "allowed_forces"}]}


def pid(setup, kp=2.0, ki=0.2):
    """`PID` once more, for programs."""
    total = np.zeros(6)

    def law(aim):
        nonlocal total
        total = total + aim.velocity_error * aim.dt
        turn = np.concatenate([np.zeros(3), aim.error[3:]])
        return setup.dynamics.total_mass @ (kp * (aim.velocity_error + turn) + ki * total)

    return law


class Pid:
    """The same as an object."""

    def __init__(self, setup, kp=2.0, ki=0.2):
        self.M, self.kp, self.ki, self.total = setup.dynamics.total_mass, kp, ki, np.zeros(6)

    def __call__(self, aim):
        """The wrench."""
        self.total += aim.velocity_error * aim.dt
        turn = np.concatenate([np.zeros(3), aim.error[3:]])
        return self.M @ (self.kp * (aim.velocity_error + turn) + self.ki * self.total)


@pytest.mark.flight
def test_a_law_of_a_file_is_the_law_a_program_hands_over(tmp_path):
    path = scenario_with(tmp_path, PID, control="{law: {python: own.py:pid, options: {kp: 3.0}}}")
    named = cube_sim.run(path, out=tmp_path / "named")
    given = cube_sim.fly(path, {"control.law.options.kp": 3.0}, controller=pid, out=tmp_path / "given")
    other = cube_sim.fly(path, {"control.law.options": {}}, controller=Pid, out=tmp_path / "other")
    assert named.verdict == given.verdict == "PASS"
    for name, rows in named.signals.items():
        assert given.signals[name].tobytes() == rows.tobytes(), name
    assert not np.array_equal(other.signals["wrench.demanded"], named.signals["wrench.demanded"])


@pytest.mark.flight
def test_the_record_holds_the_code_and_flies_again(tmp_path):
    path = scenario_with(tmp_path, PID, control="{law: {python: own.py:pid, options: {kp: 3.0}}}")
    run = cube_sim.run(path, out=tmp_path / "logs" / "a")
    contents = read_contents(run.directory / "run.mcap")
    assert contents.attachments["python/control.law/own.py"].decode() == PID
    assert contents.metadata["python"] == {"control.law": "own.py:pid"}
    assert contents.metadata["python_sha256"] == {"control.law": sha256(PID.encode()).hexdigest()}
    assert str(tmp_path).encode() not in (run.directory / "run.mcap").read_bytes()
    (code,) = read_recording(run.directory / "run.mcap").header.code
    assert (code.key, code.name, code.source) == ("control.law", "own.py:pid", PID)
    again = cube_sim.run(run.directory / "resolved.yaml", out=tmp_path / "logs" / "b")
    assert all(again.signals[name].tobytes() == rows.tobytes() for name, rows in run.signals.items())
    assert any("own.py:pid" in line for line in said(run))

    without = cube_sim.run(path, {"control.law": None}, tmp_path / "logs" / "c")
    assert "python" not in read_contents(without.directory / "run.mcap").metadata


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ("x = 1", "own.py has no make"),
        ("def mak(setup): pass", "own.py has no make; did you mean mak?"),
        ("make = 3", "own.py:make is no function or class"),
        ("def make(:", "own.py:1: SyntaxError: "),
        ("import numpy\n1 / 0", "own.py:2: ZeroDivisionError: division by zero"),
        ("import numpi", "own.py:1: ModuleNotFoundError: No module named 'numpi'"),
        ("import sys\nsys.exit('so')", "own.py:2: SystemExit: so"),
        ("def make(): pass", "own.py:make: too many positional arguments"),
        ("def make(setup):\n    raise ValueError('a\\nb')", "own.py:2: ValueError: a b"),
        ("def make(setup): return 7", "own.py:make makes a int; it takes a function of an"),
        ("class make:\n def __init__(self, setup): pass\n def decide(self): pass",
         "own.py:make makes a make without the method view and reconfigure"),
        ("def make(setup): return lambda aim: [1, 2]", "answers a wrench in two parts of shape (2,)"),
        ("def make(setup): return lambda aim: None", "answers a wrench: nothing; it takes 6 numbers"),
        ("def make(setup): return lambda aim: [float('nan')] * 6", "must be finite"),
        ("def make(setup): return lambda aim:\\\n aim.speed", "own.py:2: AttributeError"),
    ],
)  # fmt: skip
def test_what_is_no_law_is_one_line(source, told, tmp_path, monkeypatch, capsys):
    path = scenario_with(tmp_path, source, control=LAW)
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith(f"{path}:11:25: control.law.python: "), err
    assert told in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("law", "told"),
    [
        ("{python: 'other.py:make'}", "control.law.python: no such file: "),
        ("{python: 'own.py'}", "control.law.python: must be file.py:name or package.module:name, got 'own.py'"),
        ("{python: 'no.such:make'}", "control.law.python: no module 'no' on Python's path"),
        ("{python: 'own.py:make', options: {kq: 1}}", "control.law.options: own.py:make: got an unexpected keyword"),
        ("{options: {kq: 1}}", "control.law.python: this key is required"),
        ("motion_6df", "control.law: got the text 'motion_6df'; did you mean motion_6dof?"),
    ],
)
def test_what_names_no_law_is_one_line(law, told, tmp_path, monkeypatch, capsys):
    path = scenario_with(tmp_path, "def make(setup): return lambda aim: [0] * 6", control=f"{{law: {law}}}")
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert told in err


@pytest.mark.flight
@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ("1 / (aim.time < 0.2)", "own.py:2: ZeroDivisionError: division by zero"),
        ("[0.0] * (6 if aim.time < 0.2 else 5)", "own.py:make answers a wrench of shape (5,); it takes 6 numbers"),
        ("[0.0 if aim.time < 0.2 else float('inf')] * 6", "every number must be finite"),
    ],
)
def test_a_law_that_fails_in_flight_ends_it_and_keeps_the_record(answer, told, tmp_path, monkeypatch, capsys):
    source = f"def make(setup): return lambda aim: (\n    [0.0] * 6 if aim.time < 0.2 else {answer})\n"
    path = scenario_with(tmp_path, source, control=LAW)
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--json")
    assert (code, err) == (3, "")
    ended = json.loads(out)["ended_early"]
    assert ended["time_s"] == pytest.approx(0.2)
    assert ended["reason"].startswith("control.law: own.py:")
    assert told in ended["reason"]
    recording = read_recording(tmp_path / "out" / "run.mcap")
    assert recording.complete
    assert recording.signals["pose.position"][-1, 0] == pytest.approx(0.18)
    assert recording.log[-1].text.startswith(ended["reason"])


@pytest.mark.flight
@pytest.mark.parametrize("law", [pid, Pid])
def test_a_flight_with_a_law_that_remembers_is_taken_up_to_the_bit(law):
    flight = cube_sim.Flight(HELIX, SHORT, controller=law)
    for _ in range(30):
        flight.step()
    middle = pickle.loads(pickle.dumps(flight.snapshot()))
    while not flight.over:
        flight.step()
    first = flight.signals
    other = cube_sim.Flight(HELIX, SHORT, controller=law)
    other.restore(middle)
    while not other.over:
        other.step()
    flight.reset()
    while not flight.over:
        flight.step()
    for name, rows in first.items():
        assert flight.signals[name].tobytes() == rows.tobytes(), name
        late = rows[rows[:, 0] > 0.59]
        assert other.signals[name][other.signals[name][:, 0] > 0.59].tobytes() == late.tobytes(), name


def test_a_law_that_cannot_be_copied_flies_and_starts_anew():
    def law(setup):
        calls = (number for number in range(10**9))  # a generator cannot be pickled
        return lambda aim: np.array([float(next(calls)), 0.0, 0.0, 0.0, 0.0, 0.0])

    flight = cube_sim.Flight(HELIX, SHORT, controller=law)
    demanded = [flight.step().wrench[0] for _ in range(3)]
    np.testing.assert_allclose(demanded, [0.0, 1.0, 2.0], atol=1e-6)
    with pytest.raises(FlightError, match="cannot be saved"):
        flight.snapshot()
    flight.reset()
    np.testing.assert_allclose([flight.step().wrench[0] for _ in range(3)], demanded, atol=1e-9)
    assert len(flight.signals["wrench.demanded"]) == 3


def test_the_second_part_of_an_answer_gives_way():
    dear = np.array([0.0, 0.0, 0.0, 1e3, 0.0, 0.0])

    def law(setup):
        return lambda aim: (np.array([20.0, 0.0, 0.0, 0.0, 0.0, 0.0]), dear)

    flight = cube_sim.Flight(HELIX, SHORT, controller=law)
    made = flight.step().wrench
    np.testing.assert_allclose(made[[0, 1, 2, 4, 5]], [20.0, 0.0, 0.0, 0.0, 0.0], atol=1e-6)
    assert 1.0 < made[3] < 900.0
    np.testing.assert_allclose(flight.signals["wrench.demanded"][0, 1:], [20.0, 0.0, 0.0, 1e3, 0.0, 0.0])


def test_an_aim_is_the_way_to_the_target():
    seen = []

    def law(setup):
        return lambda aim: seen.append(aim) or np.zeros(6)

    attitude = {"mode": "fixed", "attitude_deg": [10.0, -20.0, 130.0]}
    settings = {**SHORT, "control.attitude": attitude, "initial.attitude_deg": [5.0, 30.0, -80.0]}
    flight = cube_sim.Flight(HELIX, {**settings, "initial.rates_deg_s": [10.0, 5.0, -8.0]}, controller=law)
    for _ in range(20):
        flight.step()
    assert [aim.time for aim in seen[-20:]] == pytest.approx(0.02 * np.arange(20))
    for aim in seen:
        state, turn = aim.state, np.empty(4)
        np.testing.assert_allclose(
            state.position + state.rotation @ aim.error[:3], aim.target_view.point.position, atol=1e-12
        )
        size = np.linalg.norm(aim.error[3:])
        mujoco.mju_axisAngle2Quat(turn, aim.error[3:] / size, size)
        wanted = rotation_from_quaternion(aim.quaternion)
        np.testing.assert_allclose(state.rotation @ rotation_from_quaternion(turn), wanted, atol=1e-12)
        np.testing.assert_allclose(
            aim.velocity_error, aim.velocity - np.concatenate([state.velocity, state.rates]), atol=1e-12
        )
    assert np.linalg.norm(seen[-1].velocity[:3]) == pytest.approx(0.4, abs=0.11)
    q = np.array([1.0, 0.0, 0.0, 0.0])
    assert not rotation_between(q, -q).any()


class WholeController:
    """Decides for itself, by the wrench that its target's distance asks for."""

    def __init__(self, setup):
        self.target, self.capability = setup.target, setup.capability

    def view(self, state):
        """See `Controller.view`."""
        return self.target.view(state.position, state.rotation @ state.velocity)

    def reconfigure(self, left):
        """See `Controller.reconfigure`."""
        self.capability = left

    def decide(self, state, applied, dt, force_ratio=1.0):
        """See `Controller.decide`."""
        view, none = self.view(state), np.zeros(3)
        self.target.advance(view.speed, dt)
        wrench = np.concatenate([(view.point.position - state.position) @ state.rotation * 10.0, none])
        q, authority = np.array([1.0, 0.0, 0.0, 0.0]), self.capability.authority
        return Decision(wrench, np.zeros(6), np.zeros(6), none, view, 1.0, none, none, q, 0.0, authority)


class NoController(WholeController):
    """Decides on a current of two components."""

    def decide(self, state, applied, dt, force_ratio=1.0):
        """See `Controller.decide`."""
        return super().decide(state, applied, dt)._replace(current=np.zeros(2))


def test_a_whole_controller_decides():
    flight = cube_sim.Flight(HELIX, SHORT, controller=WholeController)
    flight.step()
    seen = flight.step()
    assert np.linalg.norm(seen.wrench[:3]) > 0.1
    np.testing.assert_allclose(seen.wrench[3:], 0.0, atol=1e-9)
    middle = flight.snapshot()
    arc_length = flight.step().view.arc_length
    flight.restore(middle)
    assert flight.step().view.arc_length == arc_length

    with pytest.raises(ScenarioError, match=r"answers the current of shape \(2,\); it takes 3 numbers"):
        cube_sim.Flight(HELIX, SHORT, controller=NoController)


def test_the_laws_in_the_documentation_are_the_examples():
    told = re.findall(r"^```python\n(def pid.*?)```$", (REPO / "docs" / "extending.md").read_text(), re.M | re.S)
    for shown, name in zip(told, ("own_pid", "own_pid_compiled"), strict=True):
        assert shown in (REPO / "examples" / f"{name}.py").read_text()


def test_what_a_program_hands_over_is_refused_in_one_line():
    with pytest.raises(ScenarioError) as refused:
        cube_sim.Flight(HELIX, SHORT, controller=7)
    assert str(refused.value) == "override control.law: control.law.python: builtins:int is no function or class"
    with pytest.raises(ScenarioError, match=r"override control.law: .*test_own_law.py:.* KeyError: 'a'"):
        cube_sim.Flight(HELIX, SHORT, controller=lambda setup: {}["a"])


def test_a_partial_function_is_found_in_the_file_of_the_whole():
    assert source_file(partial(partial(pid, kp=3.0), ki=0.1)) == source_file(pid) != ""


@pytest.mark.flight
def test_the_keywords_of_a_partial_function_are_recorded_and_flown_again(tmp_path):
    path = scenario_with(tmp_path, PID)
    spec = importlib.util.spec_from_file_location("own_partial", tmp_path / "own.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    flown = cube_sim.fly(path, controller=partial(module.pid, kp=np.float64(3.0)), out=tmp_path / "run")
    other = cube_sim.fly(path, controller=module.pid, out=tmp_path / "other")
    recorded = cube_sim.load_run(tmp_path / "run")
    assert recorded.scenario.control.law.options == {"kp": 3.0}
    assert replay(recorded).identical
    assert not np.array_equal(flown.signals["wrench.demanded"], other.signals["wrench.demanded"])
    assert options_of(partial(pid, 1.0, a=[1, (2.0,)], b=object(), c={"d": None})) == {
        "a": [1, [2.0]],
        "c": {"d": None},
    }


def test_what_is_loaded_or_compiled_at_first_does_not_count_as_slow(tmp_path):
    def slow_to_begin(setup):
        begun = []

        def law(aim):
            if not begun:
                begun.append(time.sleep(4.0))
            return np.zeros(6)

        return law

    path = scenario_with(tmp_path, "")
    flown = cube_sim.fly(path, {"duration_s": 3.0}, controller=slow_to_begin, out=tmp_path / "run", record="none")
    assert flown.real_time_factor > 1.0


@pytest.mark.parametrize(
    "override", [{"control.law": {"options": {"kp": 3.0}}}, {"control": {"law": {"options": {"kp": 3.0}}}}]
)
def test_options_beside_what_a_program_hands_over(override):
    assert loaded_with(HELIX, override, controller=pid).scenario.control.law.options == {"kp": 3.0}


def test_no_other_law_beside_the_one_a_program_hands_over():
    with pytest.raises(ScenarioError, match=r"override control\.law: a program hands over what stands there"):
        loaded_with(HELIX, {"control.law": {"python": "x.py:y"}}, controller=pid)
    with pytest.raises(ScenarioError, match=r"override control\.law: a program hands over"):
        loaded_with(HELIX, {"control.law": "planar_lapierre_2007"}, controller=pid)


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ("np.zeros(6, complex)", "it takes 6 numbers"),
        ("['1'] * 6", "it takes 6 numbers"),
        ("np.array(['1'] * 6, object)", "it takes 6 numbers"),
        ("np.full(6, 1e300)", r"no number may be larger than 1e\+30"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_what_is_no_number_is_not_made_one(tmp_path, answer, said):
    path = scenario_with(
        tmp_path, f"import numpy as np\ndef make(setup):\n    return lambda aim: {answer}\n", control=LAW
    )
    with pytest.raises(ScenarioError, match=said):
        cube_sim.Flight(path)
