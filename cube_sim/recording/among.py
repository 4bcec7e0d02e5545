"""One vehicle among several in a record: what is recorded of it, under the names it would have alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.header import RunHeader
from cube_sim.recording.reading import Recording
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine
from cube_sim.scenario.document import parse
from cube_sim.scenario.fleet import SEPARATOR, FleetScenario
from cube_sim.scenario.fleet_loading import fleet_of
from cube_sim.scenario.resolved import to_yaml
from cube_sim.verdict import CheckResult, overall

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True)
class VehicleAmong:
    """A vehicle whose channels stand under its name, and how it is drawn.

    Attributes:
        name: of the vehicle.
        model: compiled, of its own file.
        body: the hull in it.
    """

    name: str
    model: mujoco.MjModel
    body: str


def channels_of(name: str, channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """The channel table of one vehicle, as it is alone."""
    start = f"{name}{SEPARATOR}"
    own = (channel for channel in channels if channel.name.startswith(start))
    return tuple(replace(channel, name=channel.name.removeprefix(start)) for channel in own)


def batch_of(name: str, batch: Batch, names: Sequence[str]) -> Batch:
    """What of a batch is of one vehicle, and what is said of all of them."""
    return Batch(rows_of(name, batch.rows), lines_of(name, batch.log, names))


def rows_of(name: str, rows: Mapping[str, Rows]) -> dict[str, Rows]:
    """The rows of one vehicle, by the channel's name alone."""
    start = f"{name}{SEPARATOR}"
    return {channel.removeprefix(start): rows[channel] for channel in rows if channel.startswith(start)}


def lines_of(name: str, log: Sequence[LogLine], names: Sequence[str]) -> tuple[LogLine, ...]:
    """What is said of one vehicle, without its name, and what is said of all of them."""
    own, others = f"{name}: ", tuple(f"{each}: " for each in names if each != name)
    return tuple(replace(line, text=line.text.removeprefix(own)) for line in log if not line.text.startswith(others))


def checks_of(name: str, checks: Sequence[CheckResult]) -> tuple[CheckResult, ...]:
    """The results of one vehicle's checks, by their titles alone."""
    own = f"{name}: "
    return tuple(replace(check, name=check.name.removeprefix(own)) for check in checks if check.name.startswith(own))


def fleet_in(header: RunHeader) -> FleetScenario:
    """The scenario of a record of several vehicles.

    Raises:
        RecordingError: it is none that this version knows.
    """
    try:
        return fleet_of(parse(header.resolved).data)
    except (ScenarioError, KeyError, TypeError) as error:
        raise RecordingError(f"the scenario in the record is none of this version: {error}") from None


def header_of(name: str, header: RunHeader) -> RunHeader:
    """The inputs of one vehicle's part of a run.

    Raises:
        RecordingError: as `fleet_in`.
    """
    scenario = fleet_in(header).vehicles[name]
    return replace(header, resolved=to_yaml(scenario), model=scenario.model, seed=scenario.seed, vehicles={})


def recordings_of(recording: Recording) -> dict[str, Recording]:
    """The record of several vehicles as that of each; of one, as there is no other, nothing.

    Raises:
        RecordingError: as `fleet_in`.
    """
    names = tuple(recording.header.vehicles)
    return {name: _recording_of(name, recording, names) for name in names}


def together_of(recording: Recording) -> Recording:
    """The record of several vehicles as that of one who is judged by the checks over several of them.

    Raises:
        RecordingError: as `fleet_in`.
    """
    fleet, header, end = fleet_in(recording.header), recording.header, recording.end
    scenario = fleet.together.model_copy(update={"model": fleet.first.model})
    if end is not None:
        of_one = tuple(f"{name}: " for name in header.vehicles)
        end = replace(end, checks=tuple(check for check in end.checks if not check.name.startswith(of_one)))
    header = replace(header, resolved=to_yaml(scenario), model=scenario.model, vehicles={})
    return replace(recording, header=header, end=end)


def _recording_of(name: str, recording: Recording, names: Sequence[str]) -> Recording:
    end, start = recording.end, f"{name}{SEPARATOR}"
    if end is not None:
        end = _end_of(name, end, start)
    counts = {key.removeprefix(start): count for key, count in recording.counts.items() if key.startswith(start)}
    return replace(
        recording,
        header=header_of(name, recording.header),
        vehicle=recording.header.vehicles[name],
        channels=channels_of(name, recording.channels),
        rows=rows_of(name, recording.rows),
        log=lines_of(name, recording.log, names),
        end=end,
        counts=counts,
    )


def _end_of(name: str, end: RunEnd, start: str) -> RunEnd:
    lost = {key.removeprefix(start): rows for key, rows in end.missing_rows.items() if key.startswith(start)}
    checks = checks_of(name, end.checks)
    verdict = (
        overall(checks, complete=end.how in ("completed", "stopped")) if checks and end.verdict is not None else None
    )
    return replace(end, checks=checks, verdict=verdict, missing_rows=lost)
