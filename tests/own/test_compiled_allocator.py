"""A compiled allocator of the user's own: both loops fly it to the same bits, and what is none is one line."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.command_line import call
from support.flights import FORCES_ONLY, thruster_event
from support.own_code import scenario_with
from support.places import HELIX, SCENARIOS

import cube_sim
from cube_sim.flight.compiled.loop import fly

SHORT = {"duration_s": 4.0, "checks": FORCES_ONLY}

SOURCE = """\
import numpy as np

import cube_sim


def make(setup, wrong_tick=10**9, wrong=0):
    told = {"inverse": np.linalg.pinv(setup.A), "limits": setup.limits, "wrong_tick": wrong_tick, "wrong": wrong}
    return cube_sim.compiled(allocate, told, {"before": np.zeros(len(setup.which)), "ticks": np.int64(0)})


def allocate(wrench, p, m):
    force = p.inverse @ wrench
    for i in range(len(force)):
        force[i] = min(max(0.9 * force[i] + 0.1 * m.before[i], p.limits[i, 0]), p.limits[i, 3])
        if p.limits[i, 1] < force[i] < p.limits[i, 2]:
            force[i] = 0.0
        m.before[i] = force[i]
    m.ticks += 1
    if m.ticks > p.wrong_tick:
        if p.wrong == 0:
            raise ValueError("too late")
        if p.wrong == 1:
            force[2] = np.nan
        if p.wrong == 2:
            return np.zeros(5)
        if p.wrong == 3:
            m.before[m.ticks - 101 + len(force)] = 1.0
    return force


def fading(setup):
    return cube_sim.compiled(fade, {"inverse": np.linalg.pinv(setup.A), "limits": setup.limits, "share": 1.0})


def fade(wrench, p, m):
    p.share *= 0.999
    force = p.share * (p.inverse @ wrench)
    for i in range(len(force)):
        force[i] = min(max(force[i], p.limits[i, 0]), p.limits[i, 3])
    return force


def plain(setup):
    inverse, before = np.linalg.pinv(setup.A), np.zeros(len(setup.which))
    low, edge_low, edge_high, high = setup.limits.T

    def allocate(wrench):
        force = np.clip(0.9 * (inverse @ wrench) + 0.1 * before, low, high)
        before[:] = np.where((edge_low < force) & (force < edge_high), 0.0, force)
        return before

    return allocate
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """The file."""
    file = tmp_path_factory.mktemp("own") / "own.py"
    file.write_text(SOURCE)
    return file


def by(file, name="make", **options):
    """Settings by which a scenario flies by an allocator of the file."""
    return {"allocation.method": {"python": f"{file}:{name}", "options": options}}


@pytest.mark.flight
@pytest.mark.parametrize(
    ("scenario", "settings", "least"),
    [
        (HELIX, {"duration_s": 20.0, "events": [thruster_event(8.0, ["T3"])]}, 0.8),
        (HELIX, {"events": [thruster_event(1.0, ["T1"], "weak", efficiency=0.5)], "control.faults": "told"}, 0.8),
        (SCENARIOS / "bluerov2_battery.yaml", {}, 0.9),
        (SCENARIOS / "infante_circle.yaml", {}, 0.9),
        (SCENARIOS / "cube_navigated.yaml", {}, 0.9),
    ],
    ids=["dead", "weak", "battery", "in_plane", "navigated"],
)
def test_both_loops_fly_the_same(scenario, settings, least, own, monkeypatch):
    assert assert_same_flight(scenario, {**SHORT, **by(own), **settings}, monkeypatch) > least
    assert len(fly.forms) == 1


@pytest.mark.flight
def test_it_is_the_allocator_that_it_says(own):
    one, other = (cube_sim.Flight(HELIX, {**SHORT, **by(own, name)}) for name in ("make", "plain"))
    for flight in (one, other):
        flight.fly_to_its_end()
    for name in ("thrusters.force", "wrench.allocated", "allocation.residual", "allocation.cost", "allocation.status"):
        np.testing.assert_allclose(one.signals[name], other.signals[name], rtol=1e-6, atol=1e-6, err_msg=name)


@pytest.mark.flight
@pytest.mark.parametrize("name", ["make", "fading"])
def test_all_that_it_writes_into_is_part_of_a_snapshot(name, own):
    one, other = (cube_sim.Flight(HELIX, {**SHORT, **by(own, name)}) for _ in range(2))
    one.fly(70)
    middle = pickle.loads(pickle.dumps(one.snapshot()))
    one.fly_to_its_end()
    other.restore(middle)
    other.fly_to_its_end()
    first = one.signals["wrench.allocated"]
    assert other.signals["wrench.allocated"].tobytes() == first[first[:, 0] > 1.39].tobytes()
    one.reset()
    one.fly_to_its_end()
    assert one.signals["wrench.allocated"].tobytes() == first.tobytes()


@pytest.mark.flight
@pytest.mark.parametrize("scenario", [HELIX, SCENARIOS / "cube_navigated.yaml"])
@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (0, "own.py:21: ValueError: too late"),
        (1, "own.py:make answers forces ["),
        (2, "own.py:make answers forces of shape (5,); it takes 8 numbers"),
        (3, "own.py:27: IndexError: index 8 is out of bounds for axis 0 with size 8"),
    ],
)
def test_one_that_fails_in_flight_ends_both_loops_alike(scenario, wrong, told, own, monkeypatch):
    settings = {**SHORT, **by(own, wrong_tick=100, wrong=wrong)}
    assert assert_same_flight(scenario, settings, monkeypatch) > 0.8
    flight = cube_sim.Flight(scenario, settings)
    flight.fly_to_its_end()
    assert flight.ended.startswith(f"allocation.method: {told}"), flight.ended
    assert flight.time_s == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("return p.kq * wrench", "own.py:3: cannot be compiled: neither parameters nor memory have the name 'kq'"),
        ("return wrench.nothing", "own.py:3: cannot be compiled: Unknown attribute 'nothing'"),
        ("return 7.0", "own.py:make answers, compiled, float64; it takes a new array of floats, one for each thruster"),
        ("return wrench, wrench", "own.py:make answers, compiled, array(float64, 1d, C) and array(float64, 1d, C)"),
    ],
)  # fmt: skip
def test_what_cannot_be_compiled_is_one_line(body, told, tmp_path, monkeypatch, capsys):
    source = f"import cube_sim\ndef allocate(wrench, p, m):\n    {body}\n"
    source += "def make(setup): return cube_sim.compiled(allocate)\n"
    path = scenario_with(tmp_path, source, allocation="{method: {python: 'own.py:make'}}")
    code, out, err = call(monkeypatch, capsys, "run", path, "--out", tmp_path / "out", "--quiet")
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert told in err
    assert not (tmp_path / "out").exists()
