"""The model of a record, compiled anew."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco

from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.names import MODEL
from cube_sim.recording.saved_inputs import save_inputs


def recorded_model(header: RunHeader) -> mujoco.MjModel:
    """Compile the model from the files in a record: MuJoCo tells those in memory apart by their last names alone.

    Raises:
        ValueError: it does not compile; the text is MuJoCo's.
    """
    if header.model == MODEL:  # of format 1, which has no folders
        return mujoco.MjModel.from_xml_path(header.model, dict(header.inputs))
    with TemporaryDirectory() as folder:
        save_inputs(header, Path(folder))
        return mujoco.MjModel.from_xml_path(str(Path(folder, header.model)))


def body_of(model: mujoco.MjModel, vehicle: str) -> str | None:
    """The vehicle's name where there is a body of that name; None for the first that swims."""
    return vehicle if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, vehicle) >= 0 else None
