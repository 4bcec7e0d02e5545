"""``cube-sim signals``: what a scenario records, and so what its checks may name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cube_sim.commands.ending import BAD_INPUT, stop
from cube_sim.commands.output import console_for_tables, print_json
from cube_sim.commands.settings import Settings, overrides
from cube_sim.errors import ModelError, ScenarioError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.table import Table

    from cube_sim.recording.channels import Channel, Field

EPILOG = "Exit code: 0 listed, 2 bad input."
MOST_COLUMNS = 6
"""Columns of a signal that the table names one by one; of more it names the first and the last."""
HOW_TO_USE = (
    "A check names one of them, for example signal: path_error.cross_track; component: counts its columns from 0. "
    "What is recorded on change is judged as held until its next row. "
    "The scenario's own checks and events are not examined here."
)


def signals(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO", help="Scenario file: scenarios/cube_helix.yaml.")],
    settings: Settings = None,
    json: Annotated[bool, typer.Option("--json", help="Print the list as JSON.")] = False,
) -> None:
    """List the signals a scenario records: what its checks may name, and what is read back from its recording."""
    try:
        channels, period_s = _recorded(scenario, settings)
    except (ScenarioError, ModelError) as error:
        stop(BAD_INPUT, str(error))
    if json:
        print_json(to_list(channels, period_s))
        return
    console = console_for_tables()
    console.print(signal_table(channels, period_s))
    console.print()
    console.print(HOW_TO_USE, markup=False, highlight=False, soft_wrap=True)


def _recorded(scenario: Path, settings: list[str] | None) -> tuple[tuple[Channel, ...], float]:
    """The channels of a scenario, and its control period [s].

    Its checks are not held against them: whoever looks for the name of a signal may have a wrong one in a check.
    """
    from cube_sim.scenario.fleet_loading import LoadedFleet, load_any

    loaded = load_any(scenario, overrides(settings))
    from cube_sim.mission.channels import recorded_channels
    from cube_sim.mission.hull import flown_hull

    if isinstance(loaded, LoadedFleet):
        from cube_sim.mission.fleet import fleet_channels

        each = {name: recorded_channels(one.scenario, *flown_hull(one)) for name, one in loaded.vehicles.items()}
        return fleet_channels(loaded.scenario, each), loaded.scenario.control_period_s
    return recorded_channels(loaded.scenario, *flown_hull(loaded)), loaded.scenario.control_period_s


def to_list(channels: Iterable[Channel], period_s: float) -> list[dict[str, Any]]:
    """Every signal as plain data.

    Args:
        channels: what is recorded.
        period_s: the control period [s].
    """
    return [
        {
            "signal": f"{channel.name}.{field.name}",
            "width": field.width,
            "unit": field.unit,
            "rate_hz": rate_hz(channel, period_s),
            "description": field.doc,
            "columns": list(field.columns),
            "labels": list(field.labels),
        }
        for channel in channels
        for field in channel.fields
    ]


def rate_hz(channel: Channel, period_s: float) -> float | None:
    """Rows per simulated second; None where a row comes with a change only.

    Args:
        channel: as declared; what is recorded at every tick is declared with the rate of the usual period.
        period_s: the control period [s] there really is.
    """
    from cube_sim.recording.channels import ON_CHANGE, TICK_HZ

    if channel.rate == ON_CHANGE:
        return None
    return 1.0 / period_s if channel.rate == TICK_HZ else channel.rate


def signal_table(channels: Iterable[Channel], period_s: float) -> Table:
    """A row per signal: name, columns, unit, rate, what it is.

    Args:
        channels: what is recorded.
        period_s: the control period [s].
    """
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("signal", no_wrap=True)
    table.add_column("columns", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("rate", justify="right", no_wrap=True)
    table.add_column("what it is", overflow="fold")
    for channel in channels:
        rate = rate_hz(channel, period_s)
        shown = "on change" if rate is None else f"{rate:g} Hz"
        for field in channel.fields:
            text = Text(field.doc)
            if named := _named(field):
                text.append(f"  [{named}]", "dim")
            table.add_row(Text(f"{channel.name}.{field.name}"), str(field.width), Text(field.unit), shown, text)
    return table


def _named(field: Field) -> str:
    """What its columns are called, or what its values mean."""
    if field.labels:
        return ", ".join(f"{value} {label}" for value, label in enumerate(field.labels))
    return _columns(field.columns)


def _columns(names: Sequence[str]) -> str:
    if len(names) <= MOST_COLUMNS:
        return ", ".join(names)
    return f"{names[0]}, {names[1]} ... {names[-1]}"
