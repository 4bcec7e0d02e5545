"""``cube-sim judge``: the checks of a recorded run again, or others."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, EXIT_CODES, read_or_not, stop
from cube_sim.commands.output import console_of_stdout, print_json
from cube_sim.commands.replay import RunArgument
from cube_sim.errors import RecordingError, ScenarioError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cube_sim.runs.recorded_run import RecordedRun
    from cube_sim.scenario.check_blocks import AnyCheck

EPILOG = (
    "Of a record that is not complete (cut off, recovered, of a run that was interrupted) the rows that are there "
    "judge: a check is FAIL where they show that it fails, whatever is missing, and ERROR where what is missing might "
    "change it; the whole is never a PASS. A record that was altered shows nothing. Exit code: 0 PASS, every check "
    "was shown to hold; 1 FAIL, one was shown not to; 2 bad input; 3 ERROR, nothing failed but something could not be "
    "judged, or is not complete. Nothing is written."
)


def judge(
    run: RunArgument,
    checks: Annotated[
        Path | None,
        typer.Option("--checks", metavar="FILE", help="YAML file whose checks: take the place of the scenario's."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Judge a recorded run: by the checks of its scenario, or by those of a file."""
    try:
        from cube_sim.runs.judged_record import judged_record
        from cube_sim.runs.judging import nameable
        from cube_sim.scenario.loading import load_checks

        def _checks_of(file: Path, begun: RecordedRun) -> Sequence[AnyCheck]:
            # What a check must fit beside its signals, all vehicles have alike.
            one = next(iter(begun.vehicles.values()), begun)
            return load_checks(file, one.resolved, nameable(begun), begun.fields)

        def asked(begun: RecordedRun) -> Sequence[AnyCheck] | None:
            return None if checks is None else _checks_of(checks, begun)

        found = judged_record(run, asked)
    except (RecordingError, ScenarioError) as error:
        stop(BAD_INPUT, str(error))
    with read_or_not():
        if json:
            results = [vars(result) for result in found.results]
            print_json({"verdict": found.verdict, "checks": results, "remarks": list(found.remarks)})
        else:
            from cube_sim.commands.result_table import result_table

            title = f"{found.run.whole.name}: judged again"
            console_of_stdout().print(result_table(title, found.verdict, found.results, found.remarks))
    raise typer.Exit(EXIT_CODES[found.verdict])
