"""``cube-sim sweep``: fly all samples of a scenario."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cube_sim.commands.ending import BAD_INPUT, EXIT_CODES, NOT_JUDGED, PASS, read_or_not, stop
from cube_sim.commands.leaving import SIGNALLED, raise_on_interrupt
from cube_sim.commands.output import console_for_tables, open_no_windows, print_json
from cube_sim.commands.progress import begin_compiling, sweep_progress
from cube_sim.commands.settings import Settings, overrides
from cube_sim.errors import CubeSimError, DirectoryError, ModelError, ScenarioError, SweepInterrupted

WORST = 5
"""So many of the worst samples are shown."""
NOTE_VALUES = 12
"""Of notes with more values than this nothing is shown."""
_PLAIN: dict[str, Any] = {"soft_wrap": True, "markup": False, "highlight": False}

if TYPE_CHECKING:
    from cube_sim.campaign.result import SweepResult

EPILOG = (
    "Exit code: 0 PASS, the samples show the pass rate that the scenario requires, or all pass where it requires none; "
    "1 FAIL, they show that it is not reached; 2 bad input, nothing is flown; 3 ERROR, they are too few to show "
    "either, or one could not be judged; 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP: what was flown "
    "stays, and --resume goes on with it. A part of a sweep (--shard) that must show a pass rate is judged with the "
    "others: --resume in the folder that has the files of all of them."
)


class WorkersAs(Enum):
    """In what samples are flown."""

    THREADS = "threads"
    PROCESSES = "processes"


class Kept(Enum):
    """Of which samples a recording stays."""

    NONE = "none"
    FAILURES = "failures"
    ALL = "all"


def sweep(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO", help="Scenario file with a samples: block.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the rows. Default: logs/NAME-sweep-UTC_TIME.", show_default=False)
    ] = None,
    settings: Settings = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Samples flown at a time on this machine. Default: as many as it has processors."),
    ] = None,
    workers_as: Annotated[
        WorkersAs | None,
        typer.Option(
            help="What they are flown in; the rows are the same. Default: threads where nothing of your own is flown, "
            "else processes, of which one that crashes costs its own sample only."
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Fly on the workers of a Dask cluster, by the address of its scheduler: tcp://host:8786. They see the "
            "same files and have the same cube_sim.",
        ),
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(metavar="I/N", help="Fly the I-th of N parts alone, as 2/5. The files of all may share a folder."),
    ] = None,
    keep: Annotated[
        Kept,
        typer.Option(
            help="Of which samples a recording stays, in OUT/runs: those that do not pass are flown once more for it."
        ),
    ] = Kept.NONE,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what is in OUT, after a kill too, or with more samples.")
    ] = False,
    sample_timeout_s: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            help="Of the clock, after which a sample is an ERROR. A process is ended whatever it does; a thread, and a "
            "worker of a cluster, leaves the flight once a simulated second or ten is over.",
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Show neither progress nor result.")] = False,
) -> None:
    """Fly all samples of a scenario, and count what passes."""
    result = _flown(
        scenario, settings, out, workers, workers_as, cluster, shard, keep, resume, sample_timeout_s, hidden=quiet
    )
    with read_or_not():
        if json:
            print_json(_as_plain(result))
        elif not quiet:
            _print(result)
    raise typer.Exit(PASS if result.verdict is None else EXIT_CODES[result.verdict.verdict])


def _flown(
    scenario: Path,
    settings: list[str] | None,
    out: Path | None,
    workers: int | None,
    workers_as: WorkersAs | None,
    cluster: str | None,
    shard: str | None,
    keep: Kept,
    resume: bool,
    limit_s: float | None,
    *,
    hidden: bool,
) -> SweepResult:
    """Load and fly; whatever goes wrong ends the command."""
    if resume and out is None:
        stop(BAD_INPUT, "--resume goes on with what is in a folder: say which by --out")
    if limit_s is not None and not 0.0 < limit_s < 1e9:
        stop(BAD_INPUT, f"--sample-timeout-s {limit_s:g}: must be greater than 0")
    if cluster is not None and (workers is not None or workers_as is not None):
        stop(BAD_INPUT, "--workers and --workers-as are of this machine: they do not go with --cluster")
    try:
        from cube_sim.scenario.fleet_loading import has_own_code, load_any

        loaded = load_any(scenario, overrides(settings))
        if not has_own_code(loaded):
            open_no_windows()
        from cube_sim.campaign import sweep as campaign
        from cube_sim.commands.validating import remarks_on

        begin_compiling(hidden=hidden)
        part = _shard(shard)
        for remark in () if hidden else remarks_on(loaded):
            typer.echo(f"NOTE {remark}", err=True)
        raise_on_interrupt()
        with sweep_progress(loaded.scenario.name, hidden=hidden) as progress:
            return campaign.sweep(
                loaded,
                out,
                workers=workers,
                workers_as=None if workers_as is None else workers_as.value,
                cluster=cluster,
                shard=part,
                keep=keep.value,
                resume=resume,
                limit_s=limit_s,
                progress=progress,
            )
    except (ScenarioError, ModelError, DirectoryError) as error:
        stop(BAD_INPUT, str(error))
    except CubeSimError as error:
        stop(NOT_JUDGED, str(error))
    except SweepInterrupted as interrupt:
        given = [
            *(word for setting in settings or [] for word in ("--set", setting)),
            *_option("--workers", workers),
            *_option("--workers-as", None if workers_as is None else workers_as.value),
            *_option("--cluster", cluster),
            *_option("--shard", shard),
            *_option("--keep", None if keep is Kept.NONE else keep.value),
            *_option("--sample-timeout-s", limit_s),
        ]
        words = ["cube-sim", "sweep", str(scenario), *given, "--out", str(interrupt.directory), "--resume"]
        stop(SIGNALLED + interrupt.number, f"{interrupt}\ngo on with: {shlex.join(words)}")


def _option(name: str, value: object) -> list[str]:
    """As it is written; nothing where it is not given."""
    return [] if value is None else [name, f"{value:g}" if isinstance(value, float) else str(value)]


def _shard(text: str | None) -> Any:
    from cube_sim.campaign.folder import WHOLE, Shard

    if text is None:
        return WHOLE
    match = re.fullmatch(r"([1-9][0-9]*)/([1-9][0-9]*)", text)
    if match is None or int(match[1]) > int(match[2]):
        stop(BAD_INPUT, f"--shard {text}: takes the number of a part and how many there are, from 1/5 to 5/5")
    return Shard(int(match[1]), int(match[2]))


def _as_plain(result: SweepResult) -> dict[str, Any]:
    from cube_sim.campaign.summary import check_summaries

    judged = result.verdict
    return {
        "verdict": None if judged is None else judged.verdict,
        "detail": None if judged is None else judged.detail,
        "samples": result.rows.num_rows,
        **{verdict.lower(): result.count(verdict) for verdict in ("PASS", "FAIL", "ERROR")},
        "interval": None if not result.rows.num_rows else list(result.interval[:2]),
        "checks": [summary._asdict() for summary in check_summaries(result.rows)],
        "worst": [{**each._asdict(), "command": result.command(each.sample)} for each in result.worst(WORST)],
        "directory": str(result.folder),
    }


def _note_tables(result: SweepResult) -> Iterator[Any]:
    """What came of the samples with each value of a note, of notes with few."""
    from rich.table import Table
    from rich.text import Text

    from cube_sim.campaign.counting import counted_by_note

    forecast = None if result.required is None else result.required.foretelling
    for name, counts in counted_by_note(result.rows, forecast, NOTE_VALUES).items():
        table = Table(box=None, pad_edge=False, header_style="bold")
        table.add_column(Text(name))
        should = () if forecast is None else ("should pass", "of these do")
        for heading in ("samples", "pass", "fail", "not judged", *should):
            table.add_column(heading, justify="right", no_wrap=True)
        for each in counts:
            figures = each[1:] if forecast is not None else each[1:5]
            table.add_row(Text(each.value), *map(str, figures))
        yield table


def _print(result: SweepResult) -> None:
    from rich.table import Table
    from rich.text import Text

    from cube_sim.campaign.summary import check_summaries
    from cube_sim.commands.result_table import STYLES

    console = console_for_tables()
    low, high, confidence = result.interval
    counts = f"{result.count('PASS')} pass, {result.count('FAIL')} fail, {result.count('ERROR')} could not be judged"
    judged = result.verdict
    word = "flown" if judged is None else judged.verdict
    said = "a part of the sweep" if judged is None else judged.detail
    console.print(Text.assemble((word, STYLES.get(word, "bold")), f"  {result.name}: {said}"))
    console.print(f"{counts}; pass rate {low:.4f} to {high:.4f} at {confidence:g} confidence", highlight=False)
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("check")
    for heading in ("pass", "fail", "not judged", "smallest margin", "of sample"):
        table.add_column(heading, justify="right", no_wrap=True)
    for check in check_summaries(result.rows):
        margin = "-" if check.least_margin is None else f"{check.least_margin:.4g}"
        figures = (check.passed, check.failed, check.errors, margin, "-" if check.worst is None else check.worst)
        table.add_row(Text(check.name), *map(str, figures))
    console.print(table)
    for each in _note_tables(result):
        console.print(each)
    if bad := [each for each in result.worst(WORST) if each.against]:
        console.print("\nworst samples, and how to fly them again:")
        for each in bad:
            console.print(f"  {each.sample}: {each.verdict}  {each.reason}", **_PLAIN)
            console.print(f"      {result.command(each.sample)}", **_PLAIN)
    console.print(f"\nrows: {result.folder}", **_PLAIN)
    console.print(f"a page of them: {shlex.join(['cube-sim', 'report', str(result.folder)])}", **_PLAIN)
