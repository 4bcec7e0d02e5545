"""A vehicle in its water, flown tick by tick."""

from cube_sim.flight.fleet_loop import FleetLoop
from cube_sim.flight.flight import Flight
from cube_sim.flight.loop import Loop
from cube_sim.flight.observation import Observation
from cube_sim.flight.snapshot import Snapshot
from cube_sim.flight.start import prepared, prepared_fleet

__all__ = ["FleetLoop", "Flight", "Loop", "Observation", "Snapshot", "prepared", "prepared_fleet"]
