"""A scenario with a battery: what is recorded, what the allocation makes of it, and what cannot be fed."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY, values
from support.places import HELIX, SCENARIOS
from support.vehicles import vehicle

import cube_sim
from cube_sim.allocation import Allocator, FaultTolerant, Health, Status
from cube_sim.errors import ScenarioError
from cube_sim.mission.supply import allocate_at
from cube_sim.recording.reading import read_recording

SHORT = {"duration_s": 8.0, "checks": [{"kind": "allowed_forces"}, {"kind": "exact_wrench"}]}
WEAK = {"open_circuit_V": [9.0, 10.0], "resistance_ohm": 0.1, "capacity_Wh": 1.0, "charge": 0.8}


@pytest.fixture(scope="module")
def weak(tmp_path_factory):
    """Ten volts instead of sixteen: a third of the force, and a sag that is felt."""
    return cube_sim.run(HELIX, {**SHORT, "battery": WEAK}, tmp_path_factory.mktemp("weak"))


def k_power(force: np.ndarray) -> np.ndarray:
    return np.where(force < 0.0, 1.449, 0.997) * np.abs(force) ** 1.5


@pytest.mark.flight
def test_every_row_obeys_the_laws_of_battery_and_propeller(weak):
    s = values(weak)
    power, voltage, charge = s["power.motor"], s["power.voltage"][:, 0], s["power.charge"][:, 0]
    np.testing.assert_allclose(power, k_power(s["thrusters.force"]), rtol=1e-12)
    np.testing.assert_allclose(voltage, 9.0 + charge - 0.1 * power.sum(axis=1) / voltage, rtol=1e-12)
    assert voltage.min() < 0.95 * voltage[0]
    current = power.sum(axis=1) / voltage
    drained = np.concatenate([[0.0], np.cumsum(0.02 * (power.sum(axis=1) + 0.1 * current**2))])[:-1]
    np.testing.assert_allclose(charge, 0.8 - drained / (3600.0), rtol=1e-12)
    energy = np.trapezoid(power.sum(axis=1), weak.signals["power.motor"][:, 0])
    assert s["power.energy"][-1, 0] == pytest.approx(energy, rel=1e-12)
    assert s["power.energy"][0, 0] == 0.0
    assert energy > 10.0


@pytest.mark.flight
def test_allocation_stays_inside_the_limits_of_the_moment(weak):
    """The checks of the run know the limits at its voltages; none of it is taken for a fault."""
    assert weak.checks[0].verdict == "PASS"
    s = values(weak)
    limits, voltage = s["actuation.limits"].reshape(-1, 8, 4), s["power.voltage"][:, 0]
    held = np.searchsorted(weak.signals["actuation.limits"][:, 0], weak.signals["power.voltage"][:, 0], "right") - 1
    whole = np.array([-39.91, -2.0, 2.0, 51.44])
    np.testing.assert_allclose(limits[held], (voltage / 16.0)[:, None, None] ** 2 * np.tile(whole, (8, 1)), rtol=1e-12)
    assert len(limits) > 100
    force = s["thrusters.force_demanded"]
    assert np.abs(force).max() > 0.4 * 39.91
    assert np.all(s["health.believed"] == 1.0)
    A = s["actuation.matrix"][0].reshape(6, 8)
    np.testing.assert_allclose(force @ A.T, s["wrench.allocated"], atol=1e-9)
    settled = slice(20, 30)  # a lag of 20 ms later the thrusters give what was asked for
    given, asked = s["thrusters.force"][1:][settled], force[:-1][settled]
    assert np.median(np.abs(given - asked)) < 0.05 * np.abs(asked).max()


@pytest.mark.flight
def test_the_same_bytes_again(weak, tmp_path):
    cube_sim.run(HELIX, {**SHORT, "battery": WEAK}, tmp_path / "again")
    assert (tmp_path / "again" / "run.mcap").read_bytes() == (weak.directory / "run.mcap").read_bytes()


@pytest.mark.flight
def test_without_a_battery_the_voltage_is_the_characteristics(tmp_path):
    run = cube_sim.run(HELIX, {**SHORT, "duration_s": 1.0}, tmp_path / "out")
    s = values(run)
    assert np.all(s["power.voltage"] == 16.0)
    assert "power.charge" not in s
    power = k_power(s["thrusters.force"])
    np.testing.assert_allclose(s["power.motor"], power, rtol=1e-12)
    assert s["power.energy"][-1, 0] == pytest.approx(0.02 * 0.5 * (power[1:] + power[:-1]).sum(), rel=1e-12)
    assert len(s["actuation.limits"]) == 1


@pytest.mark.flight
def test_an_empty_battery_stops_the_thrusters_and_says_so(tmp_path):
    empty = {**WEAK, "capacity_Wh": 0.3}
    run = cube_sim.run(HELIX, {**SHORT, "battery": empty, "checks": FORCES_ONLY}, tmp_path / "out")
    s = values(run)
    gone = s["power.charge"][:, 0] == 0.0
    assert 0.2 < gone.mean() < 0.95
    for name in ("power.motor", "power.voltage", "thrusters.force", "thrusters.force_demanded", "thrusters.command"):
        assert np.all(s[name][gone] == 0.0), name
        assert np.any(s[name][~gone] != 0.0), name
    first = run.signals["power.charge"][gone][0, 0]
    said = [line.t for line in read_recording(run.directory / "run.mcap").log if "battery is empty" in line.text]
    assert said == [pytest.approx(first)]
    assert np.all(np.isfinite(s["wrench.allocated"]))
    assert run.verdict == "PASS"


@pytest.mark.parametrize("stuck", [False, True])
def test_allocation_at_a_share_of_the_thrust_is_that_of_smaller_limits(stuck):
    """Attainable or not: as an allocator built for what is left of the limits."""
    A = vehicle("cube").actuation_matrix
    limits = np.tile([-39.91, -2.0, 2.0, 51.44], (8, 1))

    def build(A, limits, which):
        return Allocator(A, limits, wrench_weights=np.array([1.0, 1, 1, 30, 30, 30]))

    health = Health.whole(8).with_thruster(2, 0.5)
    rng, seen = np.random.default_rng(0), set()
    for thrust in (0.2, 0.8, 1.1):
        nominal, smaller = FaultTolerant(A, limits, build), FaultTolerant(A, limits * thrust, build)
        nominal.set_health(health.with_thruster(5, 0.0, 10.0) if stuck else health)
        smaller.set_health(health.with_thruster(5, 0.0, 10.0 * thrust) if stuck else health)
        for size in (5.0, 20.0, 80.0):
            for _ in range(5):
                wrench = size * rng.normal(size=6) * [1, 1, 1, 0.2, 0.2, 0.2]
                got, thruster_force = allocate_at(thrust, nominal, wrench)
                expected = smaller.allocate(wrench)
                np.testing.assert_allclose(got.force, expected.force, atol=1e-6)
                np.testing.assert_allclose(got.wrench, A @ got.force, atol=1e-9)
                assert got.residual == pytest.approx(expected.residual, abs=1e-6)
                assert got.cost == pytest.approx(expected.cost, rel=1e-6)
                assert got.status == expected.status
                np.testing.assert_array_equal(got.subset, expected.subset)
                obeys = np.arange(8) != 5 if stuck else np.ones(8, bool)
                given = thruster_force * np.where(np.arange(8) == 2, 0.5, 1.0) * thrust
                np.testing.assert_allclose(given[obeys], got.force[obeys], atol=1e-9)
                seen.add(got.status)
    assert {Status.EXACT, Status.CLOSEST} <= seen


def test_a_whole_voltage_changes_no_bit():
    A = vehicle("cube").actuation_matrix
    allocator = FaultTolerant(A, np.tile([-39.91, -2.0, 2.0, 51.44], (8, 1)), lambda A, limits, _: Allocator(A, limits))
    wrench = np.array([20.0, -7.0, 3.0, 1.0, -0.5, 2.0])
    got, plain = allocate_at(1.0, allocator, wrench)[0], allocator.allocate(wrench)
    assert np.array_equal(got.force, plain.force)
    assert (got.cost, got.residual) == (plain.cost, plain.residual)


@pytest.mark.parametrize(
    ("scenario", "battery", "reason"),
    [
        ("jack_exact", WEAK, "battery: .*jack.xml: T1:thruster_voltage: is not in the model"),
        ("cube_helix", {**WEAK, "open_circuit_V": [7.0, 6.0]}, r"must be \[empty, full\] with 0.01 <= empty <= full"),
        ("cube_helix", {**WEAK, "charge": 0.0}, "battery.charge: "),
        ("cube_helix", {"open_circuit_V": [6.0, 7.0]}, "battery.resistance_ohm"),
    ],
)
def test_batteries_that_make_no_sense(scenario, battery, reason, tmp_path):
    with pytest.raises(ScenarioError, match=reason):
        cube_sim.run(SCENARIOS / f"{scenario}.yaml", {"battery": battery}, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.flight
def test_what_nobody_knows_is_not_recorded_and_no_check_can_be_made_of_it(tmp_path):
    """The jack's thrusters say neither power nor voltage."""
    path, flown = SCENARIOS / "jack_exact.yaml", {"duration_s": 0.5, "checks": FORCES_ONLY}
    run = cube_sim.run(path, flown, tmp_path / "out")
    assert not [name for name in run.signals if name.startswith("power")]
    for quantity, why in {
        "energy": "the model does not state the power of each thruster",
        "voltage": "the model does not state one voltage for all thrusters",
        "charge": "the scenario has no battery",
    }.items():
        check = {"kind": "signal", "signal": f"power.{quantity}", "statistic": "final", "at_most": 100}
        with pytest.raises(ScenarioError, match=rf"checks\.0\.signal: 'power\.{quantity}' is not recorded: {why}"):
            cube_sim.run(path, {**flown, "checks": [check]}, tmp_path / "none")
