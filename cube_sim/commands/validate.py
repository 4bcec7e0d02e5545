"""``cube-sim validate``: whether scenarios can be flown, without flying them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from cube_sim.commands.ending import BAD_INPUT, PASS, stop
from cube_sim.commands.output import open_no_windows, print_json
from cube_sim.commands.settings import Settings, overrides
from cube_sim.errors import ScenarioError

EPILOG = (
    "Looked at are the files, the models they name, paths, events, the signals of checks, and samples, as before a "
    "flight. Code of your own that a scenario names is loaded and asked. Exit code: 0 all can be flown, 2 one cannot, "
    "or a folder holds none. Nothing is written."
)
Places = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE",
        help="Scenario files, and folders: searched to any depth for YAML files that hold a scenario.",
    ),
]


def validate(
    places: Places,
    settings: Settings = None,
    json: Annotated[bool, typer.Option("--json", help="Print a list, an object for each scenario.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print mistakes only.")] = False,
) -> None:
    """Say whether scenarios can be flown; a line for each mistake, with its place."""
    from cube_sim.commands.skipped import said_of_others
    from cube_sim.commands.validating import remarks_on, validated
    from cube_sim.scenario.finding import find

    open_no_windows()
    try:
        values, found = overrides(settings), find(places)
    except ScenarioError as error:
        stop(BAD_INPUT, str(error))
    wrong, remarks = dict[Path, list[str]](), dict[Path, list[str]]()
    for file in found.scenarios:
        try:
            warned: list[str] = []
            remarks[file] = remarks_on(validated(file, values, warned))
            remarks[file] += [f"{file}: {text}" for text in warned]
        except ScenarioError as error:
            wrong[file] = error.mistakes
    if json:
        print_json([as_dict(file, wrong.get(file, []), remarks.get(file, [])) for file in found.scenarios])
    else:
        for line in (line for mistakes in wrong.values() for line in mistakes):
            typer.echo(line, err=True)
        if not quiet:
            for line in (line for found_there in remarks.values() for line in found_there):
                typer.echo(f"NOTE {line}", err=True)
            right = len(found.scenarios) - len(wrong)
            typer.echo(f"{right} of {len(found.scenarios)} can be flown")
            for line in said_of_others(found.others):
                typer.echo(line)
    raise typer.Exit(BAD_INPUT if wrong else PASS)


def as_dict(file: Path, mistakes: list[str], remarks: list[str]) -> dict[str, Any]:
    """What is said of one scenario, as plain data."""
    return {"scenario": str(file), "valid": not mistakes, "mistakes": mistakes, "remarks": remarks}
