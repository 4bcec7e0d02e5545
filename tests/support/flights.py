"""What tests that fly a scenario say again and again."""

from __future__ import annotations

from cube_sim.recording.reading import read_recording

FORCES_ONLY = [{"kind": "allowed_forces"}]
"""Checks of a flight that the test itself judges."""


def thruster_event(at_s, thrusters, state="dead", **more):
    """The event that thrusters fail, or come back, at a time [s]."""
    return {"kind": "thrusters", "at_s": at_s, "thrusters": thrusters, "state": state, **more}


def values(run):
    """ "channel.field" -> (n, width) of a run: its signals without their times."""
    return {name: rows[:, 1:] for name, rows in run.signals.items()}


def said(run):
    """The lines of a run's log, in the order of time."""
    return [line.text for line in read_recording(run.directory / "run.mcap").log]
