"""A run to an .rrd file."""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from uuid import uuid4

import mujoco
import rerun as rr
import rerun.blueprint as rrb

from cube_sim.recording.among import VehicleAmong
from cube_sim.recording.batch import Batch, View
from cube_sim.recording.channels import Channel
from cube_sim.recording.header import RunHeader
from cube_sim.recording.rerun.blueprint import blueprint
from cube_sim.recording.rerun.drawing import RunDrawing
from cube_sim.recording.rerun.drawn import Drawn, drawn_from
from cube_sim.recording.rerun.fleet_drawing import FleetDrawing, distance_entities, vehicles_drawn
from cube_sim.recording.rerun.gathering import GatheringSink
from cube_sim.recording.rerun.story import Story
from cube_sim.recording.rerun.viewer import LOCAL
from cube_sim.recording.run_end import RunEnd

AnyStory = Story | Mapping[str, Story]
AnyDrawing = RunDrawing | FleetDrawing

PIECE_S = 80
"""Long pieces cost less, in time, in bytes and in what Rerun remembers of each to the end. Of more than 4096 rows the
viewer makes several."""


def rerun_sink(
    path: Path,
    header: RunHeader,
    channels: Sequence[Channel],
    model: mujoco.MjModel,
    vehicle: str | None = None,
    story: AnyStory | None = None,
    among: Sequence[VehicleAmong] = (),
) -> View:
    """Start an .rrd file that takes batches as they come.

    The vehicle is the body of that name; without a name the first with a free joint. The story is the header's, which
    takes a reader of scenarios where nobody has it ready. Of several vehicles, `among` says each; then there is a story
    of each, by name.
    """
    path.write_bytes(b"")  # a place that cannot be written is found out now
    return GatheringSink(
        RerunSink(lambda stream: stream.save(path), header, channels, model, vehicle, story, among=among), PIECE_S
    )


FLUSH_S = 10.0
"""So long the end of a view may take to be written: Rerun waits for ever for a file that it could not write."""


def live_sink(
    port: int,
    header: RunHeader,
    channels: Sequence[Channel],
    model: mujoco.MjModel,
    vehicle: str | None = None,
    among: Sequence[VehicleAmong] = (),
) -> View:
    """Show a run in a viewer that listens at a port of this machine, while it flies.

    From now on the end of the process does not wait for what is on its way to viewers.
    """
    rr.unregister_shutdown()  # it would wait for ever for a viewer that is stopped
    url = f"rerun+http://{LOCAL}:{port}/proxy"
    there = lambda stream: stream.connect_grpc(url)  # noqa: E731
    return RerunSink(there, header, channels, model, vehicle, live=True, among=among)


class RerunSink:
    """Writes a run to wherever a Rerun stream goes.

    What it writes depends on the batches, the channel table and the model, and on nothing else.
    """

    def __init__(
        self,
        send_to: Callable[[rr.RecordingStream], object],
        header: RunHeader,
        channels: Sequence[Channel],
        model: mujoco.MjModel,
        vehicle: str | None = None,
        story: AnyStory | None = None,
        live: bool = False,
        among: Sequence[VehicleAmong] = (),
    ) -> None:
        """Nothing is sent before the first batch.

        Args:
            send_to: connects the stream it is given to a file or a viewer.
            header: the inputs of the run.
            channels: the channel table.
            model: the compiled model.
            vehicle: the body that swims; None for the first that can.
            story: of the run; None for what its header tells.
            live: whether it is watched while it flies: a recording of its own beside that of the file.
            among: of several vehicles, each; none of one.
        """
        self._live, self._among = live, among
        self._send_to, self._header, self._channels = send_to, header, channels
        self._model, self._vehicle, self._story = model, vehicle, story
        self._name = ""
        self._begun: tuple[rr.RecordingStream, AnyDrawing] | None = None

    def write(self, batch: Batch) -> None:
        """Write one batch."""
        _, drawing = self._begun or self._begin(batch)
        drawing.write(batch)

    def tell(self, end: RunEnd) -> None:
        """Show how the run ended, in its text and in its name."""
        stream, drawing = self._begun or self._begin(Batch({}))
        drawing.tell(end)
        stream.send_recording_name(f"{end.verdict or end.how}: {self._name}")

    def close(self) -> None:
        """Finish the file."""
        finish(self._begun[0] if self._begun else self._begin(Batch({}))[0])

    def _begin(self, first: Batch) -> tuple[rr.RecordingStream, AnyDrawing]:
        """Name the recording and its layout: only the first batch says what the run is like."""
        identity = _identity(self._header, first)
        identity = uuid4().hex if self._live else identity
        shown = self._vehicles(first) if self._among else self._alone(first)
        # No property but its name is sent: Rerun would put the wall clock into the others.
        stream = rr.RecordingStream(shown.application, recording_id=identity[:32], send_properties=False)
        self._send_to(stream)
        drawing = shown.begin(stream)
        said = "live" if self._live else identity[:4]
        self._name = f"{shown.name or 'run'}, seed {self._header.seed}, {said}"
        stream.send_recording_name(self._name)
        stream.send_blueprint(shown.layout, make_active=True)
        self._begun = stream, drawing
        return self._begun

    def _alone(self, first: Batch) -> _Shown:
        story = self._story if isinstance(self._story, Story) else _story_of(self._header)
        drawn = drawn_from(self._channels, self._model, self._vehicle, story, first)
        begin = partial(RunDrawing, drawn=drawn, model=self._model, vehicle=self._vehicle)
        return _Shown(story.name, application_id(drawn), blueprint(drawn), begin)

    def _vehicles(self, first: Batch) -> _Shown:
        from cube_sim.recording.rerun.side_by_side import side_by_side
        from cube_sim.recording.rerun.telling import stories_of

        stories = self._story if isinstance(self._story, Mapping) else stories_of(self._header)
        drawn = vehicles_drawn(self._channels, self._among, stories, first)
        begin = partial(FleetDrawing, drawn=drawn, vehicles=self._among, channels=self._channels)
        digests = "".join(application_id(each) for each in drawn)
        application = f"cube_sim {hashlib.sha256(digests.encode()).hexdigest()[:8]}"
        layout = side_by_side(drawn, distance_entities(self._channels))
        return _Shown(" and ".join(each.name for each in self._among), application, layout, begin)


@dataclass(frozen=True)
class _Shown:
    """What a recording is called, how it is laid out, and who draws it.

    Attributes:
        name: of the scenario.
        application: name for all recordings that are laid out alike.
        layout: of the view.
        begin: makes what draws into a stream.
    """

    name: str
    application: str
    layout: rrb.Blueprint
    begin: Callable[[rr.RecordingStream], AnyDrawing]


def _story_of(header: RunHeader) -> Story:
    from cube_sim.recording.rerun.telling import story_of

    return story_of(header)


def finish(stream: rr.RecordingStream) -> None:
    """Bring a stream to where it goes, and close it.

    Raises:
        Exception: it cannot be written.
    """
    try:
        stream.flush(timeout_sec=FLUSH_S)
    except Exception:
        # Whoever lets go of it now, or ends the process, would wait for ever: nobody lets go of it.
        rr.unregister_shutdown()
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(stream))
        raise
    stream.disconnect()


def application_id(drawn: Drawn) -> str:
    """A name for all recordings that are laid out alike: the viewer gives the layout of one to all of its name."""
    digest = hashlib.sha256()
    fields = [(channel.name, field.name, field.columns) for channel in drawn.channels for field in channel.fields]
    sight = [] if not len(drawn.points) else [drawn.points.min(axis=0).tolist(), drawn.points.max(axis=0).tolist()]
    limits = [(limit.signal, limit.value) for limit in drawn.story.limits]
    for part in (
        fields,
        sight,
        limits,
        drawn.story.duration_s,
        list(drawn.boxes),
        drawn.measures.reach,
        drawn.measures.largest_N,
    ):
        digest.update(repr(part).encode() + b"\0")
    return f"cube_sim {digest.hexdigest()[:8]}"


def _identity(header: RunHeader, first: Batch) -> str:
    """Derived from the inputs and from what came of them: a run made again is the same recording.

    Another seed, and another build of the code where it flies otherwise, is another one.
    """
    digest = hashlib.sha256()
    sources = [code.source for code in header.code]
    for part in (header.resolved, str(header.seed), *map(str, sorted(header.versions.items())), *sources):
        digest.update(part.encode() + b"\0")
    for name, content in sorted(header.inputs.items()):
        digest.update(name.encode() + b"\0" + content + b"\0")
    for name, rows in sorted(first.rows.items()):
        digest.update(name.encode() + b"\0" + rows.tobytes() + b"\0")
    return digest.hexdigest()
