"""The files a scenario flies on, each under a name that depends on no machine."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import mujoco

from cube_sim.baseline import TABLE, baseline_signal, table_of_rows
from cube_sim.scenario import Scenario
from cube_sim.scenario.check_blocks import AnyCheck, BaselineCheckBlock
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
        elif kind is FileKind.RECORD:
            names[value] = value
        elif value not in names:
            files = mujoco.mju_getXMLDependencies(value) if kind is FileKind.MODEL else []
            together = sorted({os.path.normpath(file) for file in (value, *files)})
            root = os.path.commonpath([os.path.dirname(file) for file in together])
            called = {file: f"{key}/{Path(file).relative_to(root).as_posix()}" for file in together}
            contents.update({name: Path(file).read_bytes() for file, name in called.items()})
            names[value] = called[os.path.normpath(value)]
    carried = renamed(scenario, names.__getitem__)
    checks = tuple(_with_its_baseline(index, check, contents) for index, check in enumerate(carried.checks))
    return InputFiles(carried if checks == carried.checks else carried.model_copy(update={"checks": checks}), contents)


def _with_its_baseline(index: int, check: AnyCheck, contents: dict[str, bytes]) -> AnyCheck:
    """A check of an earlier run takes along what it compares with: one signal, not the whole record."""
    if not isinstance(check, BaselineCheckBlock):
        return check
    name = f"checks.{index}.record/{check.signal}{TABLE}"
    contents[name] = table_of_rows(baseline_signal(check.record, check.signal).rows)
    return check.model_copy(update={"record": name})
