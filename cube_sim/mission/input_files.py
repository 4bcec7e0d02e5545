"""The files a scenario flies on, each under a name that depends on no machine."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import mujoco

from cube_sim.scenario import Scenario
from cube_sim.scenario.file_names import FileKind, named_files, renamed


class InputFiles(NamedTuple):
    """What a run needs beside its scenario, but for Python.

    Attributes:
        scenario: the same scenario, with files called as below.
        contents: of each file that it names, and of those these refer to, by name.
    """

    scenario: Scenario
    contents: dict[str, bytes]


def input_files(scenario: Scenario) -> InputFiles:
    """Read them.

    A file is called KEY/FILE after the key that names it. What an MJCF includes, attaches or takes meshes from stands
    beside it as on disk. Python is called python/KEY/FILE, without the last part of the key, and is not read here.

    Args:
        scenario: with absolute names of files.

    Raises:
        OSError: a file cannot be read.
    """
    contents: dict[str, bytes] = {}
    names: dict[str, str] = {}
    for key, kind, value in named_files(scenario):
        if kind is FileKind.CODE:
            file = value.rpartition(":")[0]
            names.setdefault(file, f"python/{key.removesuffix('.python')}/{Path(file).name}")
        elif value not in names:
            files = mujoco.mju_getXMLDependencies(value) if kind is FileKind.MODEL else []
            together = sorted({os.path.normpath(file) for file in (value, *files)})
            root = os.path.commonpath([os.path.dirname(file) for file in together])
            called = {file: f"{key}/{Path(file).relative_to(root).as_posix()}" for file in together}
            contents.update({name: Path(file).read_bytes() for file, name in called.items()})
            names[value] = called[os.path.normpath(value)]
    return InputFiles(renamed(scenario, names.__getitem__), contents)
