"""What a run of a scenario records."""

from __future__ import annotations

from cube_sim.allocation import Status
from cube_sim.control.authority import Authority
from cube_sim.mission.navigation import channels_of
from cube_sim.recording.channels import Channel, channel_table
from cube_sim.scenario import Scenario
from cube_sim.vehicle.vehicle import Vehicle

PATH_POINTS = 400
"""Points of the polyline by which a recording shows the path."""


def recorded_channels(scenario: Scenario, vehicle: Vehicle) -> tuple[Channel, ...]:
    """The channel table of a run, with the names of the vehicle's thrusters and the scenario's sensors in it."""
    return channel_table(
        vehicle.thrusters.names,
        PATH_POINTS,
        tuple(status.name for status in Status),
        tuple(authority.name for authority in Authority),
    ) + channels_of(scenario.navigation)
