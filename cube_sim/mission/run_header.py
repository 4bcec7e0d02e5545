"""What a recording carries so that it can be run again: inputs and versions."""

from __future__ import annotations

import ctypes
import platform
from dataclasses import replace
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import numpy as np

from cube_sim.build import commit, source_digest
from cube_sim.mission.fleet import FleetMission
from cube_sim.mission.input_files import input_files
from cube_sim.mission.own.code import NO_CODES, Codes
from cube_sim.mission.own.packages import MODULES
from cube_sim.recording.header import COMMIT, SOURCE, RecordedCode, RunHeader
from cube_sim.recording.mcap.names import CODE
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.file_names import renamed
from cube_sim.scenario.fleet_loading import LoadedFleet
from cube_sim.scenario.resolved import fleet_to_yaml, to_yaml

KERNEL = "openblas kernel"
"""By which name `versions` has the kernel that OpenBLAS takes."""
PACKAGES = (
    "cube-sim",
    "llvmlite",
    "mcap",
    "mujoco",
    "numba",
    "numpy",
    "protobuf",
    "proxsuite",
    "rerun-sdk",
    "ruamel.yaml",
    "scipy",
    "zstandard",
)


@cache
def versions() -> dict[str, str]:
    """All that has a part in the numbers or in the bytes that record them, by name.

    Versions of packages and of Python, the source of cube_sim by its digest, the processor that its laws are compiled
    for, the kernel that OpenBLAS takes on it, and the C library with its sines.
    """
    from llvmlite.binding import get_host_cpu_name

    built = commit()
    library, release = platform.libc_ver()
    found = {
        "python": platform.python_version(),
        SOURCE: source_digest(),
        COMMIT: built or "",
        "processor": f"{platform.machine()} {get_host_cpu_name()}",
        KERNEL: _openblas_kernel(),
        "libc": f"{library} {release}".strip(),
        **{name: version(name) for name in PACKAGES},
    }
    return {name: told for name, told in found.items() if told}


def _openblas_kernel() -> str:
    """The name that numpy's OpenBLAS has for the kernel it has chosen; "" where numpy has no OpenBLAS of its own."""
    for library in sorted((Path(np.__file__).parents[1] / "numpy.libs").glob("libscipy_openblas64_*")):
        try:
            name = ctypes.CDLL(str(library)).scipy_openblas_get_corename64_
        except (OSError, AttributeError):
            continue
        name.restype = ctypes.c_char_p
        return name().decode(errors="replace")
    return ""


def fleet_header(loaded: LoadedFleet, mission: FleetMission) -> RunHeader:
    """The inputs of a run of several vehicles; the files of each are called after its name and their keys."""
    contents: dict[str, bytes] = {}
    vehicles: dict[str, Scenario] = {}
    for name, one in loaded.vehicles.items():
        called = partial(_of_vehicle, name)
        inputs = input_files(one.scenario)
        contents |= {called(file): content for file, content in inputs.contents.items()}
        vehicles[name] = renamed(inputs.scenario, called)
    codes, resolved = mission.codes, replace(loaded.scenario, vehicles=vehicles)
    beside = {f"{CODE}{key}/{file}": text for key, code in codes.items() for file, text in code.neighbours.items()}
    beside |= {f"{MODULES}/{file}": text for code in codes.values() for file, text in code.modules.items()}
    return RunHeader(
        scenario=loaded.text,
        resolved=fleet_to_yaml(resolved),
        model=resolved.first.model,
        inputs=contents | beside | {file: text.encode() for file, text in loaded.bases.items()},
        code=tuple(RecordedCode(key, code.name, code.source) for key, code in sorted(codes.items())),
        versions=versions(),
        seed=loaded.scenario.seed,
        vehicles={name: hull.vehicle.name for name, hull in mission.alone.items()},
    )


def _of_vehicle(name: str, file: str) -> str:
    """What a file of a vehicle's is called beside those of others."""
    return f"{CODE}vehicles.{name}.{file.removeprefix(CODE)}" if file.startswith(CODE) else f"vehicles/{name}/{file}"


def header(loaded: Loaded, codes: Codes = NO_CODES) -> RunHeader:
    """The inputs of a run; files are called after their keys, not by where this machine keeps them.

    Args:
        loaded: what is flown.
        codes: code of the user's own in it.
    """
    inputs = input_files(loaded.scenario)
    beside = {f"{CODE}{key}/{name}": text for key, code in codes.items() for name, text in code.neighbours.items()}
    beside |= {f"{MODULES}/{name}": text for code in codes.values() for name, text in code.modules.items()}
    return RunHeader(
        scenario=loaded.text,
        resolved=to_yaml(inputs.scenario),
        model=inputs.scenario.model,
        inputs=inputs.contents | beside | {name: text.encode() for name, text in loaded.bases.items()},
        code=tuple(RecordedCode(key, code.name, code.source) for key, code in sorted(codes.items())),
        versions=versions(),
        seed=loaded.scenario.seed,
    )
