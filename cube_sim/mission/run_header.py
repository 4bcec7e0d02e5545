"""What a recording carries so that it can be run again: inputs and versions."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import version

from cube_sim.mission.input_files import input_files
from cube_sim.mission.own.code import NO_CODES, Codes
from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.scenario import Loaded
from cube_sim.scenario.resolved import to_yaml

PACKAGES = ("cube-sim", "mujoco", "numba", "numpy", "proxsuite", "mcap", "rerun-sdk")


@cache
def versions() -> dict[str, str]:
    """Version of each package that takes part in the numbers or their recording, and of Python."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def header(loaded: Loaded, codes: Codes = NO_CODES) -> RunHeader:
    """The inputs of a run; files are called after their keys, not by where this machine keeps them.

    Args:
        loaded: what is flown.
        codes: code of the user's own in it.
    """
    inputs = input_files(loaded.scenario)
    return RunHeader(
        scenario=loaded.text,
        resolved=to_yaml(inputs.scenario),
        model=inputs.scenario.model,
        inputs=inputs.contents,
        code=tuple(RecordedCode(key, code.name, code.source) for key, code in sorted(codes.items())),
        versions=versions(),
        seed=loaded.scenario.seed,
    )
