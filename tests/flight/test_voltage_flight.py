"""A battery under thrusters whose tables at several voltages are known: limits and commands follow, in both loops."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import MODELS, SCENARIOS
from support.voltage_tables import PUBLISHED, numerics, powers

from cube_sim.flight import Flight
from cube_sim.vehicle.known_thrusters import known_thruster

pytestmark = pytest.mark.flight


def scenario(folder: Path) -> Path:
    """scenarios/bluerov2_battery.yaml with the published tables of its thrusters, written into a folder."""
    text = (MODELS / "bluerov2_heavy.xml").read_text()
    for name in ("characteristic", "power", "dead_zone", "voltage"):
        begin = text.index(f'<numeric name="hull:thruster_{name}"')
        text = text[:begin] + text[text.index("/>", begin) + 2 :]
    (folder / "tables.xml").write_text(text.replace("</custom>", f"{numerics()}</custom>"))
    path = folder / "tables.yaml"
    path.write_text((SCENARIOS / "bluerov2_battery.yaml").read_text().replace("../models/bluerov2_heavy", "tables"))
    return path


SHORT = {"duration_s": 6.0, "checks": [{"kind": "allowed_forces"}]}


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {
            "control.faults": "diagnosed",
            "events": [{"kind": "thrusters", "at_s": 2.0, "thrusters": ["T2"], "state": "weak", "efficiency": 0.4}],
        },
    ],
    ids=["plain", "faults"],
)
def test_both_loops_fly_the_same(tmp_path, monkeypatch, settings):
    assert assert_same_flight(scenario(tmp_path), {**SHORT, **settings}, monkeypatch) > 0.7


def test_limits_and_power_are_those_of_the_voltage_at_every_tick(tmp_path):
    flight = Flight(scenario(tmp_path), SHORT)
    flight.fly_to_its_end()
    signals = flight.signals
    voltage, limits = signals["power.voltage"][:, 1], signals["actuation.limits"][:, 1:].reshape(-1, 8, 4)
    assert np.ptp(voltage) > 0.02
    for k in (0, 50, 150, 300):
        of = known_thruster("T200", float(voltage[k]))
        expected = [of.forces[0], *of.force_dead_zone, of.forces[-1]]
        np.testing.assert_allclose(limits[k], np.tile(expected, (8, 1)), rtol=1e-9)
        given = signals["thrusters.force"][k, 1:]
        each = [np.interp(voltage[k], PUBLISHED, column) for column in powers().T]
        factors = np.where(given < 0.0, *each)
        np.testing.assert_allclose(signals["power.motor"][k, 1:], factors * np.abs(given) ** 1.5, rtol=1e-9)
    demanded = signals["thrusters.force_demanded"][:, 1:]
    assert np.all(demanded <= limits[..., 3] + 1e-9)
    assert np.all(demanded >= limits[..., 0] - 1e-9)


def test_the_law_of_the_square_would_be_another_flight(tmp_path):
    """At 12.8 to 14.8 V the square leaves 15 % too little of a curve of 16 V."""
    flight = Flight(scenario(tmp_path), SHORT)
    flight.fly_to_its_end()
    voltage, limits = flight.signals["power.voltage"][:, 1], flight.signals["actuation.limits"][:, 4]
    square = known_thruster("T200", 16.0).forces[-1] * (voltage / 16.0) ** 2
    assert np.all(limits > 1.03 * square)
