"""A compiled control law of the user's own: both loops fly it to the same bits, and what is none is one line."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.command_line import call
from support.flights import FORCES_ONLY, thruster_event
from support.own_code import scenario_with
from support.places import HELIX, SCENARIOS

import cube_sim
from cube_sim.control.own_law import PlainAim
from cube_sim.errors import ScenarioError
from cube_sim.flight.compiled.loop import fly
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import PathPoint
from cube_sim.mission.own.compiled_part import record_of_values
from cube_sim.mission.own.law import Aim
from cube_sim.recording.mcap.reader import read_contents
from cube_sim.runs.replay import replay
from cube_sim.spatial import State

LAW = "{law: {python: 'own.py:make'}}"
SHORT = {"duration_s": 4.0, "checks": FORCES_ONLY}

PID = """\
import numpy as np

import cube_sim


def make(setup, kp=2.0, ki=0.2, kd=3.0, wrong_s=1e9, wrong=0):
    told = {"M": setup.dynamics.total_mass, "kp": kp, "ki": ki, "kd": kd, "wrong_s": wrong_s, "wrong": wrong}
    return cube_sim.compiled(law, told, {"total": np.zeros(6), "ticks": 0})


def law(aim, p, m):
    m.ticks += 1
    error = np.clip(aim.error, -0.5, 0.5)
    m.total += (error + aim.velocity_error) * aim.dt
    wrench = p.M @ (p.kp * error + p.ki * m.total + p.kd * aim.velocity_error)
    if aim.time > p.wrong_s:
        if p.wrong == 0:
            raise ValueError("too late")
        if p.wrong == 1:
            wrench[2] = np.inf
        if p.wrong == 2:
            return np.zeros(5)
        if p.wrong == 3:
            m.total[int(m.ticks) - 102 + len(m.total)] = 1.0
    return wrench


def in_parts(setup):
    return cube_sim.compiled(first_the_way, {"M": setup.dynamics.total_mass})


def first_the_way(aim, p, m):
    wrench = p.M @ (0.2 * np.clip(aim.error, -0.5, 0.5) + 0.3 * aim.velocity_error)
    turning = np.zeros(6)
    turning[3:] = 1000.0 * wrench[3:]
    wrench[3:] = 0.0
    return wrench, turning


def with_all(setup):
    return cube_sim.compiled(all_of_it, {"M": setup.dynamics.total_mass})


def with_all_in_python(setup):
    class P:
        M = setup.dynamics.total_mass

    return lambda aim: all_of_it(aim, P, None)


def all_of_it(aim, p, m):
    seen, state = aim.target_view, aim.state
    point = seen.point
    way = state.rotation.T @ (point.position - state.position)
    speed = np.linalg.norm(point.rotation @ seen.velocity) + np.abs(state.velocity).sum() + np.abs(state.rates).sum()
    bends = point.curvature[0] + point.curvature[1] + point.curvature_rate[0] + point.curvature_rate[1]
    rest = seen.arc_length + seen.remaining + seen.speed + np.abs(seen.error).sum() + state.quaternion @ aim.quaternion
    wrench = p.M @ (0.2 * aim.error + aim.velocity_error + 0.01 * aim.velocity) + 0.01 * aim.applied * aim.force_ratio
    wrench[:3] += 0.1 * way + 0.1 * aim.acceleration
    wrench[5] += 1e-3 * (speed + bends + rest + aim.time + aim.dt)
    return wrench


def plain(setup, kp=2.0, ki=0.2, kd=3.0):
    M, total = setup.dynamics.total_mass, np.zeros(6)

    def law(aim):
        error = np.clip(aim.error, -0.5, 0.5)
        total[:] += (error + aim.velocity_error) * aim.dt
        return M @ (kp * error + ki * total + kd * aim.velocity_error)

    return law
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """The file as a module, and where it lies."""
    file = tmp_path_factory.mktemp("own") / "own.py"
    file.write_text(PID)
    return file


def by(file, name="make", **options):
    """Settings by which a scenario flies by a law of the file."""
    return {"control.law": {"python": f"{file}:{name}", "options": options}}


@pytest.mark.flight
@pytest.mark.parametrize(
    ("scenario", "settings", "least"),
    [
        (HELIX, {"duration_s": 40.0, "events": [thruster_event(12.0, ["T3"])]}, 0.9),
        (SCENARIOS / "bluerov2_battery.yaml", {"control.attitude": {"mode": "free"}}, 0.9),
        (SCENARIOS / "cube_look_at.yaml", {}, 0.9),
        (SCENARIOS / "cube_track.yaml", {"control.attitude": {"mode": "fixed", "attitude_deg": [0, 10, 40]}}, 0.9),
        (SCENARIOS / "cube_navigated.yaml", {"duration_s": 8.0, "current_m_s": [0.1, 0.2, 0.0]}, 0.9),
    ],
    ids=["fault", "free_on_a_battery", "look_at", "clocked", "navigated"],
)
def test_both_loops_fly_the_same(scenario, settings, least, own, monkeypatch):
    assert assert_same_flight(scenario, {**SHORT, **by(own), **settings}, monkeypatch) > least
    assert len(fly.forms) == 1


@pytest.mark.flight
def test_both_loops_let_the_second_part_give_way(own, monkeypatch):
    settings = {**SHORT, **by(own, "in_parts"), "initial.attitude_deg": [40.0, -20.0, 130.0]}
    assert assert_same_flight(HELIX, settings, monkeypatch) > 0.9
    flight = cube_sim.Flight(HELIX, settings)
    flight.fly(50)
    asked, made = (flight.signals[name][:, 1:] for name in ("wrench.demanded", "wrench.allocated"))
    np.testing.assert_allclose(made[:, :3], asked[:, :3], atol=1e-6)
    assert np.abs(made[:, 3:] - asked[:, 3:]).max() > 1.0


@pytest.mark.flight
def test_it_is_the_law_that_it_says(own):
    one, other = (cube_sim.Flight(HELIX, {**SHORT, **by(own, name, kp=1.5)}) for name in ("make", "plain"))
    for flight in (one, other):
        flight.fly_to_its_end()
    for name, rows in other.signals.items():
        np.testing.assert_allclose(one.signals[name], rows, rtol=1e-6, atol=1e-6, err_msg=name)


@pytest.mark.flight
def test_a_law_that_uses_every_field_of_its_aim_is_the_same_compiled(own):
    settings = {"duration_s": 1.0, "checks": FORCES_ONLY, "initial.attitude_deg": [4.0, -2.0, 13.0]}
    one, other = (cube_sim.Flight(HELIX, {**settings, **by(own, name)}) for name in ("with_all", "with_all_in_python"))
    for flight in (one, other):
        flight.fly_to_its_end()
        assert not flight.ended
    for name, rows in other.signals.items():
        np.testing.assert_allclose(one.signals[name], rows, rtol=1e-6, atol=1e-6, err_msg=name)
    compiled = [each for kind in (PlainAim, TargetView, PathPoint, State) for each in kind._fields]
    assert all(re.search(rf"\.{name}\b", PID) for name in compiled)
    assert set(Aim._fields) - set(PlainAim._fields) == {"capability"}


@pytest.mark.flight
def test_many_fly_beside_each_other_as_one_does_alone(own):
    settings = [{"control.law.options.kp": 1.5 + 0.5 * k} for k in range(4)]
    varied = [{**SHORT, **by(own), **each} for each in settings]
    many = cube_sim.fly_many(HELIX, varied, threads=2, signals=["pose.position"])
    for each, flown in zip(varied, many, strict=True):
        alone = cube_sim.Flight(HELIX, each)
        alone.fly_to_its_end()
        assert flown.signals["pose.position"].tobytes() == alone.signals["pose.position"].tobytes()
    assert len({flown.signals["pose.position"].tobytes() for flown in many}) == len(settings)


@pytest.mark.flight
def test_its_memory_is_part_of_a_snapshot(own):
    one, other = (cube_sim.Flight(HELIX, {**SHORT, **by(own, ki=2.0)}) for _ in range(2))
    one.fly(70)
    middle = pickle.loads(pickle.dumps(one.snapshot()))
    one.fly_to_its_end()
    other.restore(middle)
    other.fly_to_its_end()
    first = one.signals
    for name in ("pose.position", "wrench.demanded"):
        late = first[name][first[name][:, 0] > 1.39]
        assert other.signals[name].tobytes() == late.tobytes(), name
    one.reset()
    one.fly_to_its_end()
    assert one.signals["wrench.demanded"].tobytes() == first["wrench.demanded"].tobytes()


@pytest.mark.flight
@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (0, "own.py:18: ValueError: too late"),
        (1, "own.py:make answers a wrench ["),
        (2, "own.py:make answers a wrench of shape (5,); it takes 6 numbers"),
        (3, "own.py:24: IndexError: index 6 is out of bounds for axis 0 with size 6"),
    ],
)
def test_one_that_fails_in_flight_ends_both_loops_alike(wrong, told, own, monkeypatch):
    settings = {**SHORT, **by(own, wrong_s=2.0, wrong=wrong), "control.attitude": {"mode": "free"}}
    assert assert_same_flight(HELIX, settings, monkeypatch) > 0.8
    flight = cube_sim.Flight(HELIX, settings)
    flight.fly_to_its_end()
    assert flight.ended.startswith(f"control.law: {told}"), flight.ended
    assert flight.time_s == pytest.approx(2.02)
    assert flight.mission.controller.decide.__self__._memory["ticks"] == 101


@pytest.mark.flight
def test_the_record_holds_it_and_flies_again(tmp_path):
    path = scenario_with(tmp_path, PID, control=LAW)
    run = cube_sim.run(path, out=tmp_path / "run")
    assert read_contents(run.directory / "run.mcap").attachments["python/control.law/own.py"].decode() == PID
    assert replay(cube_sim.load_run(tmp_path / "run")).identical


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("[('M', 1)]", "parameters and memory are mappings of names to numbers and arrays, not a list"),
        ("{3: 1.0}", "3 is no name that a function could have as an attribute"),
        ("{'b': np.zeros(3, bool)}", "b is an array of truth values; it takes one of numbers: .astype(int)"),
        ("{'b': 'a'}", "b is a str; it takes a number or an array of numbers"),
    ],
)
@pytest.mark.parametrize("place", ["parameters", "memory"])
def test_values_that_are_none_are_refused_where_they_are_handed_on(place, given, told, tmp_path):
    source = "import numpy as np, cube_sim\ndef law(aim, p, m): return aim.error\ndef make(setup):\n"
    source += f"    return cube_sim.compiled(law, {place}={given})\n"
    with pytest.raises(ScenarioError) as caught:
        cube_sim.Flight(scenario_with(tmp_path, source, control=LAW))
    assert f"own.py:4: TypeError: {told}" in str(caught.value)


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("return p.kq * aim.error", "own.py:3: cannot be compiled: neither parameters nor memory have the name 'kq'"),
        ("m.kq += 1.0", "own.py:3: cannot be compiled: neither parameters nor memory have the name 'kq'"),
        ("m.a = np.zeros(6)", "own.py:3: cannot be compiled: numba fails here, as it does where one writes"),
        ("m.whole += aim.error", "own.py:3: cannot be compiled: numba fails here, as it does where one writes"),
        ("OUTSIDE[:] += aim.error", "own.py:3: cannot be compiled: "),
        ("with open('a') as file: pass", "own.py:3: cannot be compiled: UnsupportedBytecodeError: The 'with"),
        ("return aim.nothing", "own.py:3: cannot be compiled: Unknown attribute 'nothing' of type PlainAim"),
        ("return helper(aim.error)", "own.py:3: cannot be compiled: Untyped global name 'helper'"),
        ("return aim.error + 'a'", "own.py:3: cannot be compiled: No implementation of function"),
        ("return 7.0", "own.py:make answers, compiled, float64; it takes a new array of 6 floats, or two"),
        ("return np.zeros((2, 6))", "own.py:make answers, compiled, array(float64, 2d, C); it takes a new array"),
        ("return np.zeros(5)", "own.py:make answers a wrench of shape (5,); it takes 6 numbers"),
        ("return np.zeros(6) / 0.0", "every number must be finite"),
        ("if aim.time == 0.0: raise ValueError('a')", "own.py:3: ValueError: a"),
    ],
)  # fmt: skip
def test_what_cannot_be_compiled_is_one_line(body, told, tmp_path, monkeypatch, capsys):
    source = f"import numpy as np, cube_sim\ndef law(aim, p, m):\n    {body}\n    return np.zeros(6)\n"
    source += "def helper(x): return x\nOUTSIDE = np.zeros(6)\n"
    source += "def make(setup): return cube_sim.compiled(law, {}, {'a': np.zeros(6), 'whole': np.zeros(6, int)})\n"
    path = scenario_with(tmp_path, source, control=LAW)
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert told in err
    assert not (tmp_path / "out").exists()


def test_values_are_packed_into_whole_words():
    values = {"M": np.eye(2, dtype=int), "on": True, "n": 3, "x": np.float32(0.5)}
    (record,) = record_of_values(values)
    assert record.dtype.itemsize % 8 == 0
    for name, value in values.items():
        np.testing.assert_array_equal(record[name], value)
    assert (record["n"].dtype, record["x"].dtype, record["on"].dtype) == (np.int64, np.float64, np.bool_)
    assert record_of_values({}).itemsize == 8
    with pytest.raises(TypeError, match="name is a str; it takes a number or an array of numbers"):
        record_of_values({"name": "a"})
    with pytest.raises(TypeError, match="compiled takes a function, not a int"):
        cube_sim.compiled(7)
    with pytest.raises(TypeError, match="compiled takes a function, not a method"):
        cube_sim.compiled(Path("a").exists)


def test_a_memory_that_starts_at_a_whole_number_need_not_stay_one():
    start = {"z": 0, "list": [0, 0], "on": True, "count": np.int64(0), "counts": np.zeros(2, int)}
    memory = cube_sim.compiled(lambda aim, p, m: aim.error, {"n": 0}, start).memory
    assert [memory.dtype[name].base.kind for name in start] == list("ffbii")
    assert cube_sim.compiled(lambda aim, p, m: aim.error, {"n": 0}).parameters.dtype["n"] == np.int64
