"""``cube-sim examples``: models and scenarios to start from, copied to a folder of one's own."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from cube_sim.commands.ending import BAD_INPUT, stop
from cube_sim.commands.output import to_paste
from cube_sim.errors import DirectoryError
from cube_sim.shipped import shipped_root

EPILOG = "Exit code: 0 copied, 2 the folder cannot take them, and nothing is written."
SCENARIOS = (
    "cube_helix",
    "bluerov2_arm",
    "bluerov2_free",
    "bluerov2_vectored_helix",
    "infante_line",
    "jack_exact",
    "nps_auv2_line",
    "remus100_line",
    "remus100_propeller",
    "rov6_helix",
    "torpedo_line",
)
"""One for each vehicle; the first is the one to begin with."""

_PACKAGE = Path(__file__).resolve().parents[1]


def examples(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to copy to: new, or empty.")],
) -> None:
    """Copy models and scenarios to start from."""
    try:
        written = copy_examples(directory)
    except DirectoryError as error:
        stop(BAD_INPUT, str(error))
    for path in written:
        typer.echo(path)
    typer.echo()
    first = next(path for path in written if path.name == f"{SCENARIOS[0]}.yaml")
    typer.echo(f"fly one:  {to_paste('run', first)}")


def example_files(package: Path = _PACKAGE) -> dict[str, Path]:
    """Where each example stands, by the name it gets in the folder.

    Args:
        package: the folder of the package `cube_sim`.
    """
    root = shipped_root(package)
    names = [f"models/{model.name}" for model in sorted((root / "models").glob("*.xml"))]
    names += [f"scenarios/{name}.yaml" for name in SCENARIOS]
    return {name: root / name for name in (*names, "scenarios/scenario.schema.json")}


def copy_examples(directory: Path, files: Mapping[str, Path] | None = None) -> list[Path]:
    """Copy the examples; those that are there already, as they were copied before, are no hindrance.

    Args:
        directory: a new or empty folder, or one that holds nothing but examples nobody has changed.
        files: the examples, see `example_files`.

    Returns:
        The files written, the models first.

    Raises:
        DirectoryError: the folder holds something else, or cannot be written.
    """
    contents = {directory / name: source.read_bytes() for name, source in (files or example_files()).items()}
    try:
        for there in _files_below(directory):
            if there not in contents or there.read_bytes() != contents[there]:
                raise DirectoryError(
                    f"{directory}: holds {there.relative_to(directory)}, which is not an unchanged example: "
                    "give a new or empty folder"
                )
        for path, content in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    except OSError as error:
        raise DirectoryError(f"{directory}: cannot hold the examples: {error.strerror or error}") from error
    return list(contents)


def _files_below(directory: Path) -> list[Path]:
    """Every file in a folder and the folders below it; none where there is no such folder.

    Raises:
        NotADirectoryError: it is a file.
    """
    if not directory.is_dir():
        if directory.exists() or directory.is_symlink():
            raise NotADirectoryError(20, os.strerror(20))
        return []
    return sorted(path for path in directory.rglob("*") if not path.is_dir())
