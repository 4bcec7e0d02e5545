"""Views made of records alone: ``run.rrd`` again, or several runs in one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import rerun as rr

from cube_sim.errors import RecordingError
from cube_sim.recording.among import VehicleAmong, header_of
from cube_sim.recording.batch import split_into_batches
from cube_sim.recording.reading import Recording, read_recording
from cube_sim.recording.recorded_model import body_of, recorded_model
from cube_sim.recording.rerun.drawing import RunDrawing
from cube_sim.recording.rerun.drawn import drawn_from
from cube_sim.recording.rerun.gathering import gathered
from cube_sim.recording.rerun.side_by_side import looks, side_by_side
from cube_sim.recording.rerun.sink import PIECE_S, finish, rerun_sink
from cube_sim.recording.rerun.telling import story_of


def rrd_from_mcap(mcap: Path, rrd: Path) -> None:
    """Write the Rerun recording that belongs to a record.

    Args:
        mcap: the record; one that a crash cut short gives the view of what it holds.
        rrd: file to write.

    Raises:
        RecordingError: the record cannot be read, or its model cannot be compiled.
    """
    opened = _Opened.read(mcap)
    recording = opened.recording
    among = vehicles_among(recording, mcap)
    sink = rerun_sink(rrd, recording.header, recording.channels, opened.model, opened.vehicle, among=among)
    for batch in split_into_batches(recording.rows, recording.log):
        sink.write(batch)
    if recording.end is not None:
        sink.tell(recording.end)
    sink.close()


def vehicles_among(recording: Recording, mcap: Path) -> list[VehicleAmong]:
    """Of a record of several vehicles, each with its compiled model; of one, nothing.

    Raises:
        RecordingError: a model cannot be compiled.
    """
    found = []
    for name, body in recording.header.vehicles.items():
        try:
            found.append(VehicleAmong(name, recorded_model(header_of(name, recording.header)), body))
        except ValueError as error:
            raise RecordingError(f"{mcap}: the recorded model of {name} does not compile: {error}") from None
    return found


def rrd_from_records(mcaps: Sequence[Path], names: Sequence[str], rrd: Path) -> None:
    """Write one Rerun recording that shows several records on one time.

    Args:
        mcaps: up to `MOST_RUNS` records.
        names: of the runs, all different.
        rrd: file to write.

    Raises:
        RecordingError: a record cannot be read, or its model cannot be compiled.
    """
    opened = [_Opened.read(mcap) for mcap in mcaps]
    pieces = [gathered(split_into_batches(o.recording.rows, o.recording.log), PIECE_S) for o in opened]
    shown = [
        drawn_from(o.recording.channels, o.model, o.vehicle, story_of(o.recording.header), batches[0], places, look)
        for o, batches, (places, look) in zip(opened, pieces, looks(names), strict=True)
    ]
    stream = rr.RecordingStream("cube_sim side by side", send_properties=False)
    stream.save(rrd)
    for o, batches, drawn in zip(opened, pieces, shown, strict=True):
        drawing = RunDrawing(stream, drawn, o.model, o.vehicle)
        for batch in batches:
            drawing.write(batch)
        if o.recording.end is not None:
            drawing.tell(o.recording.end)
    stream.send_recording_name(" beside ".join(names))
    stream.send_blueprint(side_by_side(shown), make_active=True)
    finish(stream)


@dataclass(frozen=True)
class _Opened:
    """A record and its compiled model.

    Attributes:
        recording: the record.
        model: compiled.
        vehicle: the body that swims; None for the first that can.
    """

    recording: Recording
    model: mujoco.MjModel
    vehicle: str | None

    @classmethod
    def read(cls, mcap: Path) -> _Opened:
        recording = read_recording(mcap)
        try:
            model = recorded_model(recording.header)
        except ValueError as error:
            raise RecordingError(f"{mcap}: the recorded model does not compile: {error}") from None
        return cls(recording, model, body_of(model, recording.vehicle))
