"""Several scenarios flown one after the other: one table, one exit code."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cube_sim.commands.account import early_end, lasted
from cube_sim.commands.ending import BAD_INPUT, EXIT_CODES
from cube_sim.errors import CubeSimError, DirectoryError, ScenarioError
from cube_sim.verdict import CheckResult, Flown, to_dict

if TYPE_CHECKING:
    from rich.console import RenderableType

    from cube_sim.scenario.fleet_loading import AnyLoaded
    from cube_sim.simulation import Progress, Run

INVALID = "INVALID"
"""In place of a verdict, of a scenario that cannot be flown."""
_WORST_FIRST = ("FAIL", INVALID, "ERROR", "PASS")


@dataclass(frozen=True)
class ScenarioOutcome:
    """What became of one scenario.

    Attributes:
        file: it.
        verdict: PASS, FAIL, ERROR or `INVALID`.
        worst: the check that failed, could not be judged, or passed with least to spare; None where none was judged.
        lasted: how much was simulated, in words.
        reasons: why it is no PASS, in lines.
        content: for JSON.
    """

    file: Path
    verdict: str
    worst: CheckResult | None
    lasted: str
    reasons: tuple[str, ...]
    content: Mapping[str, Any]

    @property
    def directory(self) -> str:
        """Where it is recorded; "" where nothing is."""
        return self.content.get("directory", "")


def outcome_of(file: Path, loaded: AnyLoaded, run: Run) -> ScenarioOutcome:
    """Of a flight."""
    flown = Flown(run.simulated_s, run.ended_early, run.log)
    content = to_dict(run.verdict, run.checks, run.real_time_factor, run.versions, flown)
    reasons = [f"{check.verdict} {check.name}: {check.detail}" for check in run.checks if check.verdict != "PASS"]
    return ScenarioOutcome(
        file,
        run.verdict,
        worst_of(run.checks),
        lasted(run, loaded.scenario.duration_s),
        (*early_end(run), *reasons),
        {"scenario": str(file), **content, "directory": str(run.directory)},
    )


def invalid(file: Path, error: CubeSimError) -> ScenarioOutcome:
    """Of a scenario that cannot be flown; its mistakes are lines."""
    mistakes = error.mistakes if isinstance(error, ScenarioError) else str(error).splitlines()
    content = {"scenario": str(file), "verdict": INVALID, "mistakes": mistakes}
    return ScenarioOutcome(file, INVALID, None, "", tuple(mistakes), content)


def broken_off(file: Path, error: CubeSimError) -> ScenarioOutcome:
    """Of a flight that came to no end: the disk is full, code of the user's own raised."""
    content = {"scenario": str(file), "verdict": "ERROR", "reason": str(error)}
    return ScenarioOutcome(file, "ERROR", None, "", (str(error),), content)


def worst_of(checks: Sequence[CheckResult]) -> CheckResult | None:
    """The check that says most of a run: a failed one, one not judged, or that with the least share to spare."""

    def rank(check: CheckResult) -> tuple[int, float]:
        place = ("FAIL", "ERROR", "PASS").index(check.verdict)
        if check.margin is None:
            return place, 0.0
        return place, check.margin / (abs(check.limit) or 1.0)

    return min(checks, key=rank, default=None)


def folders(out: Path | None, scenarios: Mapping[Path, AnyLoaded]) -> dict[Path, Path | None]:
    """A folder of its own in `out` for each file, called after the scenario; None for each where no folder is given.

    Raises:
        DirectoryError: one of them cannot take a recording, or `out` is the folder of a run.
    """
    if out is None:
        return dict.fromkeys(scenarios)
    from cube_sim.run_directory import FILES, require_writable

    if any((out / file).exists() for file in FILES):
        raise DirectoryError(f"{out}: is the folder of a run; give a new one, in which each scenario gets its own")
    chosen: dict[Path, Path | None] = {}
    for file, loaded in scenarios.items():
        name, count = loaded.scenario.name, 1
        while out / (name if count == 1 else f"{name}-{count}") in chosen.values():
            count += 1
        chosen[file] = folder = out / (name if count == 1 else f"{name}-{count}")
        require_writable(folder)
    return chosen


def fly_one(file: Path, loaded: AnyLoaded, out: Path | None, record: Any, progress: Progress) -> ScenarioOutcome:
    """Fly a scenario that is valid; what goes wrong on the way is its outcome."""
    from cube_sim import simulation

    try:
        run = simulation.fly(loaded, out=out, progress=progress, record=record, keep_signals=record != "none")
    except (ScenarioError, DirectoryError) as error:
        return invalid(file, error)
    except CubeSimError as error:
        return broken_off(file, error)
    return outcome_of(file, loaded, run)


def exit_code(outcomes: Iterable[ScenarioOutcome]) -> int:
    """That of the worst: a FAIL, else a scenario that cannot be flown, else one not judged."""
    verdicts = {outcome.verdict for outcome in outcomes}
    worst = next(verdict for verdict in _WORST_FIRST if verdict in verdicts)
    return BAD_INPUT if worst == INVALID else EXIT_CODES[worst]


def table_of(outcomes: Sequence[ScenarioOutcome], not_flown: Sequence[Path] = ()) -> RenderableType:
    """A row for each scenario, then why those that did not pass did not.

    Args:
        outcomes: in the order in which they were asked for.
        not_flown: what an interrupt has left.
    """
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    styles = {"PASS": "bold green", "FAIL": "bold red", "ERROR": "bold magenta", INVALID: "bold yellow"}
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("scenario", "verdict", "worst check"):
        table.add_column(heading, overflow="fold", no_wrap=heading == "verdict")
    for heading in ("value", "limit", "margin"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("flown", overflow="fold")
    table.add_column("recorded in", overflow="fold")
    for outcome in outcomes:
        cells = ["", "", "", "", ""]
        if (worst := outcome.worst) is not None:
            limit = f"{worst.relation} {_number(worst.limit)}"
            cells = [worst.name, _number(worst.value), limit, _number(worst.margin), worst.unit]
        verdict = Text(outcome.verdict, styles[outcome.verdict])
        flown = outcome.lasted.removesuffix(" simulated")
        table.add_row(Text(str(outcome.file)), verdict, *map(Text, cells), Text(flown), Text(outcome.directory))
    for file in not_flown:
        table.add_row(Text(str(file)), Text("not flown"))
    counts = [(word, sum(outcome.verdict == word for outcome in outcomes)) for word in _WORST_FIRST]
    worst_word = next((word for word, count in counts if count), "")
    told = ", ".join(f"{count} {word}" for word, count in reversed(counts) if count)
    heading = Text.assemble((worst_word, styles.get(worst_word, "bold")), f"  {told} of {len(outcomes)} scenarios")
    reasons = [Text(f"{outcome.file}: {line}") for outcome in outcomes for line in _with_place(outcome)]
    return Group(heading, Text(), table, *([Text(), *reasons] if reasons else []))


def _with_place(outcome: ScenarioOutcome) -> list[str]:
    """Reasons; mistakes have been said, and name their file themselves."""
    return [] if outcome.verdict == INVALID else list(outcome.reasons)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
