"""What a scenario asks for and this vehicle, or any run, cannot give: found before the run, not after it."""

from __future__ import annotations

from difflib import get_close_matches

from cube_sim.errors import ScenarioError
from cube_sim.recording.channels import Channel
from cube_sim.scenario import Loaded
from cube_sim.scenario.check_blocks import SignalCheck
from cube_sim.scenario.event_blocks import ThrusterEvent
from cube_sim.vehicle.vehicle import Vehicle


def require_signals(loaded: Loaded, channels: tuple[Channel, ...]) -> None:
    """Refuse checks of signals that no run records."""
    widths = {f"{channel.name}.{field.name}": field.width for channel in channels for field in channel.fields}
    mistakes = []
    for i, check in enumerate(loaded.scenario.checks):
        if not isinstance(check, SignalCheck):
            continue
        if check.signal not in widths:
            near = get_close_matches(check.signal, widths, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(widths)}"
            mistakes.append(loaded.mistake(f"checks.{i}.signal", f"no signal '{check.signal}' is recorded, {hint}"))
        elif check.component is not None and check.component >= widths[check.signal]:
            last = widths[check.signal] - 1
            mistakes.append(loaded.mistake(f"checks.{i}.component", f"{check.signal} has columns 0 to {last}"))
    if mistakes:
        raise ScenarioError(mistakes)


def require_possible_events(loaded: Loaded, vehicle: Vehicle) -> None:
    """Refuse events that cannot happen to this vehicle."""
    thrusters, duration = vehicle.thrusters, loaded.scenario.duration_s
    mistakes = []
    for i, event in enumerate(loaded.scenario.events):
        if event.at_s > duration:
            text = f"{event.at_s:g} s is after the end of the run at {duration:g} s"
            mistakes.append(loaded.mistake(f"events.{i}.at_s", text, because="duration_s"))
        if not isinstance(event, ThrusterEvent):
            continue
        for j, name in enumerate(event.thrusters):
            if name not in thrusters.names:
                text = f"no thruster '{name}'; the model has {', '.join(thrusters.names)}"
                mistakes.append(loaded.mistake(f"events.{i}.thrusters.{j}", text))
            elif event.force_N is not None:
                low, _, _, high = thrusters.limits[thrusters.names.index(name)]
                if not low <= event.force_N <= high:
                    text = f"{name} cannot be stuck at {event.force_N:g} N; it gives {low:g} to {high:g} N"
                    mistakes.append(loaded.mistake(f"events.{i}.force_N", text))
    if mistakes:
        raise ScenarioError(mistakes)
