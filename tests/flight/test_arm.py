"""A vehicle with an arm in a mission: both loops the same, its links in the water, its controller holding it."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.command_line import call
from support.places import MODELS, SCENARIOS

from cube_sim.flight import Flight
from cube_sim.mission import prepare
from cube_sim.scenario import load

ARM, MODEL = SCENARIOS / "bluerov2_arm.yaml", MODELS / "bluerov2_arm.xml"
CHECKS = {"checks": [{"kind": "allowed_forces"}]}
WATER = ("volume", "added_mass", "quadratic_damping", "centre_of_buoyancy")


def dry_arm(folder):
    """The same scenario with a model whose links have no water; the hull then has their volume at rest."""
    text = MODEL.read_text()
    for link in ("upper_arm", "forearm"):
        for name in WATER:
            start = text.index(f'<numeric name="{link}:{name}"')
            text = text[:start] + text[text.index("/>", start) + 2 :]
    # stretched ahead, the vehicle is trimmed as the other is: 0.0157 m^3 in all
    text = text.replace('data="0.014"', 'data="0.0157"').replace("0.02 0 0.014", "0.0784713 0 -0.0048408")
    (folder / "arm.xml").write_text(text)
    return {"model": str(folder / "arm.xml")}


@pytest.mark.parametrize(
    "changes", [{}, {"navigation": {}}, {"physics": {"integrator": "implicitfast", "step_s": 0.002}}]
)
def test_both_loops_fly_the_same(changes, monkeypatch):
    settings = {
        **CHECKS,
        "duration_s": 6,
        "setpoints": {"shoulder": {"times_s": [1, 2, 4], "values": [0.0, 0.8, -0.5]}},
        **changes,
    }
    assert assert_same_flight(ARM, settings, monkeypatch) > 0.9


@pytest.mark.flight
def test_the_controller_holds_what_the_arm_does():
    flight = Flight(ARM)
    flight.fly_to_its_end()
    t, (shoulder, elbow) = flight.signals["setpoints.reached"][:, 0], flight.signals["setpoints.reached"][:, 1:].T
    assert np.ptp(shoulder) > 2.3
    assert np.ptp(elbow) > 1.3
    late = t > 8
    assert np.abs(flight.signals["path_error.along"][late, 1]).max() < 0.05
    assert flight.signals["path_error.cross_track"][late, 1].max() < 0.05
    yaw = np.abs(flight.signals["wrench.demanded"][:, 6])
    assert yaw[(t > 10) & (t < 25)].max() > 5.0 * yaw[(t > 9) & (t < 10)].max()  # there was something to hold


@pytest.mark.flight
def test_links_with_water_swing_another_vehicle_than_dry_ones(tmp_path):
    """Both hang still alike; a swing throws the hull of wet links further: they take water along, and it drags."""
    thrown = []
    for changes in ({}, dry_arm(tmp_path)):
        flight = Flight(ARM, {**changes, "duration_s": 20})
        flight.fly_to_its_end()
        t, wrench = flight.signals["wrench.allocated"][:, 0], flight.signals["wrench.allocated"][:, 1:]
        # held still they differ by the drag of the arm in the current alone
        assert np.abs(wrench[(t > 9) & (t < 9.9), 2]).max() < 1.0
        thrown.append(np.abs(wrench[(t > 10) & (t < 12.5), 5]).max())
    assert thrown[0] > 1.2 * thrown[1]


def test_whoever_reckons_with_the_vehicle_has_its_links():
    """At time 0 of the scenario; the sums are those of the links' own numerics, stretched ahead."""
    mission = prepare(load(ARM))
    hull = mission.vehicle
    assert hull.displaced_mass == pytest.approx(1000.0 * (0.014 + 2 * 0.00085))
    assert hull.mass == pytest.approx(15.7)
    assert hull.centre_of_buoyancy[0] == pytest.approx(hull.centre_of_mass[0], abs=1e-12)
    # heave: hull, and two links across; pitch by heave: their middles, 0.41 and 0.71 m ahead
    assert hull.added_mass[2, 2] == pytest.approx(18.68 + 2 * 0.7634)
    assert hull.added_mass[4, 2] == pytest.approx(-0.7634 * (0.41 + 0.71), rel=2e-3)
    assert hull.quadratic_damping[1, 1] == pytest.approx(217.0 + 2 * 6.66)
    folded = prepare(load(ARM, {"setpoints": {"elbow": {"times_s": [0], "values": [1.5]}}})).vehicle
    assert folded.added_mass[4, 2] > hull.added_mass[4, 2] + 0.2


def test_analyze_counts_the_links(tmp_path, monkeypatch, capsys):
    """Its course across depends on what the water damps, its margins on what it takes along: the links' too."""
    wet, dry = (
        call(monkeypatch, capsys, "analyze", model)[1].partition("\n")[2]
        for model in (MODEL, dry_arm(tmp_path)["model"])
    )
    assert "weighs 154 N, displaces 154 N of water: neutral" in wet
    assert "weighs 154 N, displaces 154 N of water: neutral" in dry
    assert wet.partition("margins")[2] != dry.partition("margins")[2]
