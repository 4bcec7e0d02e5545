"""Many flights at once: each is the one that would be flown alone, to the bit."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from support.own_code import scenario_with
from support.places import HELIX, SCENARIOS

import cube_sim
from cube_sim import many_flights
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight
from cube_sim.flight_statistics import statistics_of
from cube_sim.scenario import load
from cube_sim.scenario.shared import Shared
from cube_sim.vehicle.compiled_once import CompiledOnce

CHECKS = [{"kind": "allowed_forces"}]
LOST = {"kind": "thrusters", "at_s": 2.0, "thrusters": ["T3"], "state": "dead"}
STUCK = {"kind": "thrusters", "at_s": 1.0, "thrusters": ["T1"], "state": "stuck", "force_N": -20.0}
SIGNALS = ["pose.position", "thrusters.force", "health.believed", "allocation.status"]
VARIATIONS = [
    {"duration_s": 6.0},
    {"duration_s": 5.0, "current_m_s": [0.0, 0.3, 0.1]},
    {"duration_s": 6.0, "events": [LOST]},
    {"duration_s": 6.0, "events": [STUCK, LOST]},
    {"duration_s": 4.0, "initial.position_m": [0.0, 0.0, -0.2]},
    {"duration_s": 4.0, "control.attitude": {"mode": "look_at", "point_m": [3.0, 0.0, -4.0]}},
]


def alone(scenario, variation):
    """The flight of one variation, nobody else in the air."""
    flight = Flight(scenario, {"checks": CHECKS, **variation})
    flight.fly_to_its_end()
    return flight


@pytest.mark.flight
@pytest.mark.parametrize("threads", [1, 2, 5])
def test_each_flight_is_the_one_flown_alone(threads):
    varied = [{"checks": CHECKS, **variation} for variation in VARIATIONS]
    flown = cube_sim.fly_many(HELIX, varied, threads=threads, signals=SIGNALS)
    assert [outcome.variation for outcome in flown] == varied
    for outcome, variation in zip(flown, VARIATIONS, strict=True):
        single = alone(HELIX, variation)
        for name in SIGNALS:
            assert outcome.signals[name].tobytes() == single.signals[name].tobytes(), (variation, name)
        assert outcome.log == tuple(line for line in single.log if line.level == "WARNING")
        assert outcome.verdict == "PASS"
        assert outcome.simulated_s == variation["duration_s"]
        assert outcome.statistics == statistics_of(single.signals)
    assert [outcome.statistics["thrusters_lost"] for outcome in flown] == [0.0, 0.0, 1.0, 2.0, 0.0, 0.0]


NUMBERS = {
    "cube_helix": [{"hull:mass": [m], "hull:inertia": [5.0, 6.0, 7.0, 0.1, 0.0, -0.1 * m / 125.0]} for m in (124, 127)],
    "bluerov2_free": [{"hull:quadratic_damping": [40.0 * k] * 6, "T3:thruster_lag": [0.1 * k]} for k in (1.0, 1.1)],
    "rov6_helix": [{"hull:volume": [0.0204 * k], "hull:centre_of_mass": [0.0, 0.0, -0.01 * k]} for k in (1.0, 1.01)],
    "remus100_line": [{"hull:linear_damping": [2.0 * k, 1, 1, 1, 1, 1], "hull:mass": [30.5 * k]} for k in (1.0, 1.003)],
    "bluerov2_battery": [{"water:density": [1000.0 * k]} for k in (1.0, 1.02)],
}


@pytest.mark.flight
@pytest.mark.parametrize("name", NUMBERS)
def test_a_vehicle_whose_model_others_had_compiled_leaves_the_record_of_one_alone(name, tmp_path, monkeypatch):
    """To the byte, whoever came first; and the file is compiled once."""
    scenario, shared, compiled = SCENARIOS / f"{name}.yaml", Shared(), []
    whole = CompiledOnce.of
    monkeypatch.setattr(CompiledOnce, "of", lambda *given: compiled.append(given) or whole(*given))
    checks = [{"kind": "allowed_forces"}]
    for k, parameters in enumerate([*NUMBERS[name], NUMBERS[name][0]]):
        loaded = load(scenario, {"duration_s": 3.0, "checks": checks, "events": [], "parameters": parameters})
        together, alone = replace(loaded, shared=shared), loaded
        for kept, one in ((f"together{k}", together), (f"alone{k}", alone)):
            count = len(compiled)
            cube_sim.fly(one, out=tmp_path / kept, record="mcap")
            assert (len(compiled) > count) == (one is alone or k == 0)
        records = [(tmp_path / f"{kept}{k}" / "run.mcap").read_bytes() for kept in ("together", "alone")]
        assert records[0] == records[1]
        if k == 1:
            assert records[0] != (tmp_path / "alone0" / "run.mcap").read_bytes()


@pytest.mark.flight
def test_seeds_navigate_their_own_ways():
    scenario = SCENARIOS / "cube_navigated.yaml"
    varied = [{"seed": seed, "duration_s": 3.0, "checks": CHECKS} for seed in (1, 2, 1)]
    one, two, again = cube_sim.fly_many(scenario, varied, threads=2, signals=["navigation.position"])
    first = one.signals["navigation.position"]
    assert first.tobytes() == again.signals["navigation.position"].tobytes()
    assert not np.allclose(first, two.signals["navigation.position"], atol=1e-6)
    assert first.tobytes() == alone(scenario, varied[0]).signals["navigation.position"].tobytes()


@pytest.mark.flight
def test_proxqp_confirms_on_request_and_changes_nothing():
    varied = [{"duration_s": 1.0, "checks": CHECKS}]
    (bare,), (confirmed,) = (
        cube_sim.fly_many(HELIX, varied, signals=["thrusters.command"], confirm=confirm) for confirm in (False, True)
    )
    command = bare.signals["thrusters.command"]
    assert command.tobytes() == confirmed.signals["thrusters.command"].tobytes()


@pytest.mark.flight
def test_statistics_are_those_of_the_signals():
    flight = alone(HELIX, {"duration_s": 5.0})
    signals = flight.signals
    numbers = statistics_of(signals)
    distance = np.hypot(*signals["path_error.lateral"][:, 1:].T)
    assert numbers["cross_track_max_m"] == pytest.approx(distance.max(), rel=1e-12)
    assert numbers["cross_track_rms_m"] == pytest.approx(np.sqrt(np.mean(distance**2)), rel=1e-12)
    assert numbers["energy_J"] == signals["power.energy"][-1, 1] > 0.0
    assert numbers["travelled_m"] == pytest.approx(np.ptp(signals["target.arc_length"][:, 1]))
    assert numbers["thrusters_lost"] == 0.0


def test_who_cannot_fly_is_named_before_anybody_does():
    with pytest.raises(ScenarioError) as refused:
        cube_sim.fly_many(HELIX, [{"seed": 1}, {"guidance.speed_m_s": -1.0}])
    assert "variation 1" in str(refused.value)
    assert "guidance.speed_m_s" in str(refused.value)
    with pytest.raises(ValueError, match="threads is 0"):
        cube_sim.fly_many(HELIX, [{}], threads=0)
    with pytest.raises(ValueError, match=r"no signal 'pose\.place'"):
        cube_sim.fly_many(HELIX, [{"duration_s": 0.1, "checks": CHECKS}], signals=["pose.place"])

    with pytest.raises(ValueError, match="a list of names"):
        cube_sim.fly_many(HELIX, [{}], signals="pose.position")
    with pytest.raises(ValueError, match="variation 1 is 3"):
        cube_sim.fly_many(HELIX, [{}, 3])


FIRST = """
import cube_sim, sys
checks = [{"kind": "allowed_forces"}]
flown = cube_sim.fly_many(sys.argv[1], [{"duration_s": 0.5, "seed": k, "checks": checks} for k in range(4)], threads=2)
print(*[outcome.verdict for outcome in flown])
"""


@pytest.mark.flight
def test_it_may_be_the_first_thing_a_process_does():
    done = subprocess.run([sys.executable, "-c", FIRST, str(HELIX)], capture_output=True, text=True, timeout=300)
    assert done.stderr == ""
    assert done.stdout.split() == ["PASS"] * 4


@pytest.mark.flight
def test_one_that_fails_brings_the_others_down():
    """Within a simulated second or ten, though they would fly for hours."""
    hours = {"duration_s": 36000.0, "checks": CHECKS}
    with pytest.raises(ValueError, match="no signal"):
        cube_sim.fly_many(HELIX, [hours, {"duration_s": 0.1, "checks": CHECKS}], threads=2, signals=["a.b"])
    started = time.monotonic()
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.alarm(2)
    with pytest.raises(KeyboardInterrupt):
        cube_sim.fly_many(HELIX, [hours, hours], threads=2)
    assert time.monotonic() - started < 60.0


def test_none_are_none():
    assert cube_sim.fly_many(HELIX, []) == []


@pytest.mark.flight
def test_a_signal_that_one_flight_does_not_record_costs_nobody_his_outcome():
    short = {"duration_s": 1.0, "checks": CHECKS}
    names = ["sensor_dvl.innovation", "pose.position"]
    estimated, known = cube_sim.fly_many(HELIX, [{**short, "navigation": {}}, short], signals=names)
    assert set(estimated.signals) == set(names)
    assert set(known.signals) == {"pose.position"}
    assert known.log[0].text == "this flight does not record sensor_dvl.innovation"
    assert not [line for line in estimated.log if "record" in line.text]
    assert known.verdict == "PASS"
    with pytest.raises(ValueError, match=r"no signal 'pose\.pos'; there are "):
        cube_sim.fly_many(HELIX, [short], signals=["pose.pos"])


@pytest.mark.flight
def test_of_a_long_flight_what_was_asked_for_is_kept_alone(monkeypatch):
    stores = []

    class Watched(many_flights.AskedStore):
        def __init__(self, *given):
            super().__init__(*given)
            stores.append(self)

    monkeypatch.setattr(many_flights, "AskedStore", Watched)
    (outcome,) = cube_sim.fly_many(HELIX, [{"duration_s": 90.0, "checks": CHECKS}], signals=["pose.position"])
    assert len(outcome.signals["pose.position"]) == 4501
    assert outcome.statistics == statistics_of(alone(HELIX, {"duration_s": 90.0}).signals)
    (store,) = stores
    held = sum(rows.nbytes for parts in store._written.values() for rows in parts)
    held += sum(len(buffer) for buffer in store._buffers.values())
    assert held == 0


@pytest.mark.flight
@pytest.mark.parametrize(("threads", "most"), [(None, 1), (3, 3)])
def test_flights_of_own_code_take_turns_unless_told_otherwise(tmp_path, threads, most):
    """Three laws meet at a barrier, or never do."""
    source = """
    import threading, time
    inside, most, lock = [], [], threading.Lock()
    meeting = threading.Barrier(3)

    def make(setup, wait=False):
        def law(aim):
            if aim.time == 0.1 and wait:
                meeting.wait(60)
            with lock:
                inside.append(1)
                most.append(len(inside))
            time.sleep(0.001)
            with lock:
                inside.pop()
            return [0.0] * 6
        return law
    """
    path = scenario_with(tmp_path, source)
    law = {"python": "own.py:make", "options": {"wait": most > 1}}
    varied = [{"control.law": law, "seed": seed} for seed in range(3)]
    outcomes = cube_sim.fly_many(path, [*varied, {"seed": 3}], threads=threads)
    assert [outcome.ended_early for outcome in outcomes] == [None] * 4
    (own,) = [
        module for name, module in sys.modules.items() if getattr(module, "__file__", "") == str(tmp_path / "own.py")
    ]
    assert max(own.most) <= most
