"""What a recording carries so that it can be run again: inputs and versions."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

import mujoco

from cube_sim.mission.own.code import NO_CODES, Codes
from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.scenario import Loaded
from cube_sim.scenario.file_names import renamed
from cube_sim.scenario.resolved import to_yaml

PACKAGES = ("cube-sim", "mujoco", "numba", "numpy", "proxsuite", "mcap", "rerun-sdk")


@cache
def versions() -> dict[str, str]:
    """Version of each package that takes part in the numbers or their recording, and of Python."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def header(loaded: Loaded, codes: Codes = NO_CODES) -> RunHeader:
    """The inputs of a run; files are called by their name, not by where this machine keeps them.

    Args:
        loaded: what is flown.
        codes: code of the user's own in it.
    """
    model = Path(loaded.scenario.model)
    portable = renamed(loaded.scenario, lambda file: Path(file).name)
    return RunHeader(
        scenario=loaded.text,
        resolved=to_yaml(portable),
        mjcf=model.read_text(encoding="utf-8"),
        assets=_assets(model),
        code=tuple(RecordedCode(key, code.name, code.source) for key, code in sorted(codes.items())),
        versions=versions(),
        seed=loaded.scenario.seed,
    )


def _assets(model: Path) -> dict[str, bytes]:
    """The files an MJCF refers to, by the name it uses."""
    spec = mujoco.MjSpec.from_file(str(model))
    groups = (
        (spec.meshdir, (mesh.file for mesh in spec.meshes)),
        (spec.meshdir, (hfield.file for hfield in spec.hfields)),
        (spec.texturedir, (texture.file for texture in spec.textures)),
    )
    return {name: (model.parent / folder / name).read_bytes() for folder, names in groups for name in names if name}
