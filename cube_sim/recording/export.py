"""``run.rrd`` made again from ``run.mcap`` alone."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import split_into_batches
from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.names import MODEL
from cube_sim.recording.reading import read_recording
from cube_sim.recording.rerun.sink import rerun_sink
from cube_sim.recording.saved_inputs import save_inputs


def rrd_from_mcap(mcap: Path, rrd: Path) -> None:
    """Write the Rerun recording that belongs to a record.

    Args:
        mcap: the record; one that a crash cut short gives the view of what it holds.
        rrd: file to write.

    Raises:
        RecordingError: the record cannot be read, or its model cannot be compiled.
    """
    recording = read_recording(mcap)
    header = recording.header
    try:
        model = _compiled(header)
    except ValueError as error:
        raise RecordingError(f"{mcap}: the recorded model does not compile: {error}") from None
    named = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, recording.vehicle) >= 0
    sink = rerun_sink(rrd, header, recording.channels, model, recording.vehicle if named else None)
    for batch in split_into_batches(recording.rows, recording.log):
        sink.write(batch)
    sink.close()


def _compiled(header: RunHeader) -> mujoco.MjModel:
    """The recorded model, from files: MuJoCo tells those it is given in memory apart by their last names alone."""
    if header.model == MODEL:  # of format 1, which has no folders
        return mujoco.MjModel.from_xml_path(header.model, dict(header.inputs))
    with TemporaryDirectory() as folder:
        save_inputs(header, Path(folder))
        return mujoco.MjModel.from_xml_path(str(Path(folder, header.model)))
