"""A damaged record written anew, without what cannot be read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import split_into_batches
from cube_sim.recording.mcap.fleet_scene import FleetSceneRows
from cube_sim.recording.mcap.scene import SceneRows
from cube_sim.recording.mcap.sink import AnySceneRows, McapSink
from cube_sim.recording.reading import CANNOT_KNOW, Recording, read_recording
from cube_sim.recording.run_end import RunEnd
from cube_sim.recording.salvage import salvage
from cube_sim.run_directory import MCAP_FILE, RRD_FILE, Claim, claim
from cube_sim.runs.losses import told as told_losses
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.whole_file import written_whole

_MOST_TOLD = 3
"""So many losses are named in a line; the spans of time that they leave out are all named beside it."""


@dataclass(frozen=True)
class Recovered:
    """What became of a recovery.

    Attributes:
        directory: where the new record is, and its view.
        recorded_s: how far the record goes [s].
        missing: which channels lack how many rows, and from when to when, a line each.
        changed: what of that which is there is not as it was recorded; "" where nothing is known to be.
        dropped: what could not be read, a line each.
        refused: why every other reader refuses the record though its rows seem to be all; "" where that is not so.
        view: why the view could not be made; "" if it was.
    """

    directory: Path
    recorded_s: float
    missing: tuple[str, ...]
    changed: str
    dropped: tuple[str, ...]
    refused: str
    view: str


def recover(record: Path, directory: Path) -> Recovered | str:
    """Write what can be read of a record into a folder, and its view.

    Args:
        record: the MCAP file.
        directory: new, empty, or that of an earlier run, which is replaced once the new record is whole.

    Returns:
        Why there is nothing to recover, in words, where the record holds all it ever did: nothing is written then.

    Raises:
        RecordingError: nothing can be read of it.
        DirectoryError: the folder holds something else, or cannot be written.
        OSError: the disk is full, or gone.
    """
    if directory.resolve() == record.parent.resolve():
        raise RecordingError(f"{directory}: is the folder of the record itself; give another")
    found = salvage(record)
    run = RecordedRun(record, found.recording, None)
    seems_whole = _holds_all(run) and (run.complete or not found.dropped)
    refused = _refused(record) if seems_whole else ""
    if seems_whole and not refused:
        return _nothing_to_recover(run)
    before, changed = run.end, found.recording.changed
    whole = {channel.name for channel in found.recording.channels if channel.every_tick}
    lost = told_losses(run.losses, whole)
    because = changed or _told(found.dropped) or (_told(lost) if run.altered else run.flaw) or refused
    end = RunEnd(
        "recovered",
        because,
        None if before is None else before.ticks,
        None if before is None else before.simulated_s,
        missing_s=run.missing_s,
        missing_rows={loss.channel: loss.rows for loss in run.losses},
    )
    with claim(directory, run.whole.name) as place:
        _write(place, found.recording, end)
        said = tuple(lost), changed, found.dropped, refused
        return Recovered(place.directory, run.recorded_s, *said, _view(place.directory))


def _refused(record: Path) -> str:
    """Why every other reader refuses a record, all of whose pieces may be sound; "" where it is read."""
    try:
        read_recording(record)
    except RecordingError as error:
        return str(error)
    return ""


def _holds_all(run: RecordedRun) -> bool:
    """Whether nothing was lost or altered since it was written."""
    stopped = run.end is not None and not run.end.of_itself
    return run.complete or run.flaw == CANNOT_KNOW or (stopped and not run.altered)


def _nothing_to_recover(run: RecordedRun) -> str:
    if run.complete:
        return "is complete; there is nothing to recover"
    if run.end is not None and run.end.how == "recovered":
        return "is a recovered record already; there is nothing more to recover in it"
    return f"holds all that was recorded ({run.flaw}); there is nothing to recover"


def _told(dropped: Sequence[str]) -> str:
    """What could not be read, in one line."""
    more = f"; and {len(dropped) - _MOST_TOLD} more" if len(dropped) > _MOST_TOLD else ""
    return "; ".join(dropped[:_MOST_TOLD]) + more


def _write(place: Claim, recording: Recording, end: RunEnd) -> None:
    """Write the record, whole or not at all; an earlier run goes once there is another."""
    with written_whole(place.directory / MCAP_FILE) as part:
        scene = _scene(recording, place.directory / MCAP_FILE)
        sink = McapSink(part, recording.header, recording.channels, recording.vehicle, scene)
        try:
            for batch in split_into_batches(recording.rows, recording.log):
                sink.write(batch)
            sink.finish(end)
        finally:
            sink.close()
        place.begin(but=(MCAP_FILE,))


def _scene(recording: Recording, record: Path) -> AnySceneRows | None:
    """What other programs' viewers draw; None where a model does not compile."""
    from cube_sim.recording.export import vehicles_among
    from cube_sim.recording.recorded_model import body_of, recorded_model

    try:
        if recording.header.vehicles:
            return FleetSceneRows(recording.channels, vehicles_among(recording, record))
        model = recorded_model(recording.header)
    except (ValueError, RecordingError):
        return None
    return SceneRows(recording.channels, model, body_of(model, recording.vehicle), recording.vehicle)


def _view(folder: Path) -> str:
    """Make the view; why that was not possible, in one line."""
    from cube_sim.recording.export import rrd_from_mcap

    try:
        with written_whole(folder / RRD_FILE) as part:
            rrd_from_mcap(folder / MCAP_FILE, part)
    except Exception as error:  # the view is made of the record again whenever somebody wants it
        return " ".join(str(error).split())
    return ""
