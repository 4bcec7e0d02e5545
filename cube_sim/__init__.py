"""Underwater vehicles in MuJoCo: real water, 3-D path following, exact thruster allocation, recordings.

`load_model`, `Vehicle` and `install` need only MuJoCo; `run` and `fly` are the whole loop. Names are resolved when
first used, so that importing the package costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cube_sim.flight import Flight, Observation, Snapshot
    from cube_sim.many_flights import FlightOutcome, fly_many
    from cube_sim.mission.own.compiled_part import compiled
    from cube_sim.runs.recorded_run import RecordedRun, load_run
    from cube_sim.simulation import Run, fly, run
    from cube_sim.vehicle.changing import set_parameters
    from cube_sim.vehicle.loading import load_model
    from cube_sim.vehicle.plugin.hook import install
    from cube_sim.vehicle.vehicle import Vehicle

__all__ = [
    "Flight",
    "FlightOutcome",
    "Observation",
    "RecordedRun",
    "Run",
    "Snapshot",
    "Vehicle",
    "compiled",
    "fly",
    "fly_many",
    "install",
    "load_model",
    "load_run",
    "run",
    "set_parameters",
]

_HOME = {
    "Flight": "cube_sim.flight",
    "Observation": "cube_sim.flight",
    "Snapshot": "cube_sim.flight",
    "Run": "cube_sim.simulation",
    "Vehicle": "cube_sim.vehicle.vehicle",
    "FlightOutcome": "cube_sim.many_flights",
    "compiled": "cube_sim.mission.own.compiled_part",
    "fly": "cube_sim.simulation",
    "fly_many": "cube_sim.many_flights",
    "install": "cube_sim.vehicle.plugin.hook",
    "load_model": "cube_sim.vehicle.loading",
    "load_run": "cube_sim.runs.recorded_run",
    "RecordedRun": "cube_sim.runs.recorded_run",
    "run": "cube_sim.simulation",
    "set_parameters": "cube_sim.vehicle.changing",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'cube_sim' has no attribute '{name}'; it has {', '.join(__all__)}")
