"""``cube-sim diff``: two runs, signal by signal."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, FAIL, PASS, read_or_not, stop
from cube_sim.commands.output import console_for_tables, print_json
from cube_sim.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from cube_sim.runs.comparison import InputDifference, SignalDifference
    from cube_sim.runs.recorded_run import RecordedRun

EPILOG = (
    "Exit code: 0 the same within the tolerances, row for row; 1 something differs, rows that one of them lacks "
    "included; 2 bad input. Values of the scenario and files that are not the same are named, files by the start of "
    "their SHA-256; they change no exit code. A record that is not complete is told on stderr."
)


def diff(
    one: Annotated[Path, typer.Argument(metavar="A", help="Folder of a run, or its run.mcap.")],
    other: Annotated[Path, typer.Argument(metavar="B", help="Another.")],
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance",
            metavar="[SIGNAL=]NUMBER",
            help="Differences up to this, in the signal's unit, do not count: pose.position=1e-9. SIGNAL may be a "
            "channel; without it the number holds for all signals. Default: 0, every bit. May be repeated.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the differences as JSON.")] = False,
) -> None:
    """Compare two runs: which settings and files, which signals, from when on, and by how much."""
    try:
        from cube_sim.runs.comparison import differences, other_files, other_settings
        from cube_sim.runs.recorded_run import load_run

        runs = load_run(one), load_run(other)
        allowed = _tolerances(tolerance or [], runs[0])
        found = list(differences(runs[0].signals, runs[1].signals, allowed.__getitem__))
        settings = other_settings(runs[0].resolved, runs[1].resolved)
        files = other_files(runs[0].header, runs[1].header)
    except (RecordingError, ValueError) as error:
        stop(BAD_INPUT, str(error))
    for run in runs:
        if run.flaw:
            typer.echo(f"{run.path}: {run.flaw}", err=True)
    with read_or_not():
        if json:
            inputs = {"settings": [vars(each) for each in settings], "files": [vars(each) for each in files]}
            print_json({**inputs, "signals": [each.to_dict() for each in found]})
        else:
            inputs = _lines("setting", settings, _value) + _lines("file", files, _digest)
            for line in [*inputs, *[""] * bool(inputs and found)]:
                typer.echo(line)
            if found:
                console_for_tables().print(_table(found, runs[0]))
            else:
                typer.echo(f"the same: {len(runs[0].signals)} signals")
    raise typer.Exit(FAIL if found else PASS)


_DIGEST, _MOST = 12, 60
"""So many characters are shown of a digest and of a value."""


def _lines(what: str, others: Sequence[InputDifference], shown: Callable[[str], str]) -> list[str]:
    return [f"{what} {each.key}: {shown(each.one) or 'none'} against {shown(each.other) or 'none'}" for each in others]


def _digest(whole: str) -> str:
    return whole[:_DIGEST]


def _value(whole: str) -> str:
    return whole if len(whole) <= _MOST else f"{whole[: _MOST - 3]}..."


class _Tolerances(dict[str, float]):
    """By signal or channel; "" for all others."""

    def __missing__(self, signal: str) -> float:
        return self.get(signal.partition(".")[0], self.get("", 0.0))


def _tolerances(given: Sequence[str], run: RecordedRun) -> _Tolerances:
    """Read ``SIGNAL=NUMBER``.

    Raises:
        ValueError: one line on the argument that is none.
    """
    from difflib import get_close_matches

    found = _Tolerances()
    known = {*run.fields, *(channel.name for channel in run.recording.channels)}
    for argument in given:
        name, equals, number = argument.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            value = -1.0
        if not 0.0 <= value < inf or (equals and not name):
            text = "write SIGNAL=NUMBER, 0 or more and finite, for example pose.position=1e-9"
            raise ValueError(f"--tolerance {argument}: {text}")
        if name and name not in known:
            near = get_close_matches(name, known, n=1)
            meant = f"; did you mean {near[0]}?" if near else ""
            raise ValueError(f"--tolerance {argument}: no signal {name}{meant}")
        found[name] = value
    return found


def _table(found: Sequence[SignalDifference], run: RecordedRun) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("signal", no_wrap=True)
    for heading in ("first at", "largest", "at", "rows"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", overflow="fold")
    for each in found:
        unit = run.fields[each.signal].unit if each.signal in run.fields else "1"
        unit = "" if unit == "1" else f" {unit}"
        numbers = ["-", "-", "-", "-"]
        if each.first_s is not None:
            numbers = [f"{each.first_s:g} s", f"{each.largest:.3g}{unit}", f"{each.largest_s:g} s", str(each.rows)]
        table.add_row(Text(each.signal), *numbers, Text(each.text))
    return table
