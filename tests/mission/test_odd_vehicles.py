"""Vehicles nobody would build, but somebody will write down: they fly, or are refused in a line."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support.edited_cube import edited_text
from support.flights import FORCES_ONLY
from support.places import HELIX
from support.scenario_files import FLIGHT

import cube_sim
from cube_sim.errors import CubeSimError
from cube_sim.recording.reading import read_signals

DAMPING = re.compile(r'<numeric name="hull:(linear|quadratic)_damping" data="[^"]*"/>')


def with_thrusters(*names):
    """The CUBE's file with these of its thrusters only."""
    text = edited_text()
    for name in {f"T{i}" for i in range(1, 9)} - set(names):
        text = re.sub(rf'\s*<(site|general) name="{name}"[^>]*/>', "", text)
    return text


def short_flight(folder, text, **changes):
    (folder / "hull.xml").write_text(text)
    (folder / "mission.yaml").write_text(FLIGHT)
    changes = {"model": str(folder / "hull.xml"), "checks": FORCES_ONLY} | changes
    return cube_sim.run(folder / "mission.yaml", changes, out=folder / "run")


@pytest.mark.parametrize("names", [("T1",), ("T1", "T2"), ("T1", "T2", "T8")])
def test_a_vehicle_of_a_few_thrusters_is_flown_and_its_record_read_back(names, tmp_path):
    run = short_flight(tmp_path, with_thrusters(*names))
    assert run.verdict == "PASS"
    for signals in (run.signals, read_signals(run.directory / "run.mcap")):
        for signal in ("thrusters.command", "thrusters.force", "allocation.subset", "power.motor", "health.believed"):
            assert signals[signal].shape == (26, 1 + len(names))


def test_a_vehicle_without_thrusters_is_refused_in_a_line(tmp_path):
    with pytest.raises(CubeSimError, match=r"'hull' has no thruster$"):
        short_flight(tmp_path, with_thrusters())


def test_one_whose_actuators_are_no_thrusters_is_told_what_they_lack(tmp_path):
    plain = edited_text().replace('biastype="user"', "")
    with pytest.raises(
        CubeSimError, match=r"'hull' has no thruster: actuator 'T1' pushes .* it has no biastype=\"user\""
    ):
        short_flight(tmp_path, plain)


@pytest.mark.flight
def test_a_hull_without_drag_follows_the_helix(tmp_path):
    (tmp_path / "hull.xml").write_text(DAMPING.sub("", edited_text()))
    run = cube_sim.run(HELIX, {"model": str(tmp_path / "hull.xml")}, out=tmp_path / "run")
    assert run.verdict == "PASS"
    assert np.abs(run.signals["water.estimated"][:, 1:]).max() < 1e-9  # nothing shows it the current
