"""Blocks of a run to Rerun columns: the one way from recorded numbers to ``run.rrd``."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import rerun as rr
from numpy.typing import NDArray

from cube_sim.recording.batch import Batch, Rows, Sink
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import thruster_mounts
from cube_sim.recording.header import RunHeader
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.blueprint import blueprint
from cube_sim.recording.rerun.gathering import GatheringSink
from cube_sim.recording.rerun.plots import Lane, curves, lanes
from cube_sim.recording.rerun.scene import (
    ARROW_M_PER_M_S,
    ARROW_M_PER_N,
    CURRENT,
    ESTIMATE,
    ESTIMATE_TRAIL,
    LOG,
    PATH,
    TARGET,
    THRUST,
    TRAIL,
    VEHICLE,
    log_estimate_styles,
    log_scene,
)

TIMELINE = "sim_time"
_TRAIL_HZ = 10
_LEVELS = {"WARNING": "WARN", "FATAL": "CRITICAL"}  # where the viewer has another word


PIECE_S = 80
"""Long pieces cost less, in time, in bytes and in what Rerun remembers of each to the end. Of more than 4096 rows the
viewer makes several."""


def rerun_sink(
    path: Path, header: RunHeader, channels: Sequence[Channel], model: mujoco.MjModel, vehicle: str | None = None
) -> Sink:
    """Start an .rrd file that takes batches as they come.

    The vehicle is the body of that name; without a name the first with a free joint.
    """
    return GatheringSink(RerunSink(path, header, channels, model, vehicle), PIECE_S)


class RerunSink:
    """Writes a run to an .rrd file.

    What it writes depends on the batches, the channel table and the model, and on nothing else.
    """

    def __init__(
        self,
        path: Path,
        header: RunHeader,
        channels: Sequence[Channel],
        model: mujoco.MjModel,
        vehicle: str | None = None,
    ) -> None:
        self._channels = tuple(channels)
        self._columns = {
            (channel.name, field.name): columns
            for channel in self._channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }
        self._curves = curves(self._channels)
        self._lanes = lanes(self._channels)
        self._lane_codes: dict[str, float] = {}
        self._shown: dict[str, NDArray[Any]] = {}
        self._axes = thruster_mounts(model, vehicle).axes
        self._trail_ends: dict[str, NDArray[np.float64]] = {}
        self._laid_out = False
        self._duration_s = _duration_s(header)
        # No property is sent: Rerun would put the wall clock into it.
        self._recording = rr.RecordingStream("cube_sim", recording_id=_recording_id(header), send_properties=False)
        self._recording.save(path)
        self._boxes = log_scene(self._recording, model, vehicle)
        self._log_styles()

    def write(self, batch: Batch) -> None:
        """Write one batch."""
        if not self._laid_out:
            self._laid_out = True
            self._lay_out(batch)
        for name, rows in batch.rows.items():
            self._draw(name, rows)
        for curve in self._curves:
            if curve.channel in batch.rows:
                rows = batch.rows[curve.channel]
                values = self._values(rows, curve.channel, curve.field)
                values = values[:, list(curve.columns)] if curve.columns else values
                scalars = rr.Scalars.columns(scalars=np.ascontiguousarray(values).ravel())
                n = values.shape[1]
                self._send(curve.entity, rows, scalars if n == 1 else scalars.partition([n] * len(rows)))
        for lane in self._lanes:
            if lane.channel in batch.rows:
                self._write_lane(lane, batch.rows[lane.channel])
        if batch.log:
            t = np.array([[line.t] for line in batch.log])
            text, level = [line.text for line in batch.log], [_LEVELS.get(line.level, line.level) for line in batch.log]
            self._send(LOG, t, rr.TextLog.columns(text=text, level=level))

    def close(self) -> None:
        """Finish the file."""
        if not self._laid_out:
            self._lay_out(Batch({}))
        self._recording.flush()
        self._recording.disconnect()

    def _draw(self, name: str, rows: Rows) -> None:
        """Draw in 3-D what a channel has to show there."""
        if name == "pose":
            position = self._values(rows, name, "position")
            self._send_pose(VEHICLE, rows, name)
            # The arrow of the current goes along with the vehicle.
            self._send(CURRENT, rows, rr.Transform3D.columns(translation=position))
            self._draw_trail(TRAIL, rows, position)
        elif name == "navigation":
            position, sigma = (self._values(rows, name, field) for field in ("position", "position_sigma"))
            self._send(ESTIMATE, rows, rr.Ellipsoids3D.columns(centers=position, half_sizes=2.0 * sigma))
            self._draw_trail(ESTIMATE_TRAIL, rows, position)
        elif name == "target":
            self._send_pose(TARGET, rows, name)
        elif name == "path":
            points = self._values(rows, name, "points").astype(np.float32).reshape(len(rows), -1, 3)
            n = len(rows)
            self._send(
                PATH,
                rows,
                rr.LineStrips3D.columns(strips=points, colors=[palette.PATH] * n, radii=[0.02] * n),
            )
        elif name == "thrusters" and len(self._axes):
            force = self._values(rows, name, "force")
            m, arrows = len(self._axes), force[:, :, None] * self._axes * ARROW_M_PER_N
            self._send(THRUST, rows, rr.Arrows3D.columns(vectors=arrows.reshape(-1, 3)).partition([m] * len(rows)))
            # What is not sent stays as it was shown last.
            turned = self._changes(THRUST, force >= 0.0)
            colours = palette.by_sign(force[turned].ravel())
            if turned.size:
                self._send(THRUST, rows[turned], rr.Arrows3D.columns(colors=colours).partition([m] * len(turned)))
        elif name == "water":
            current = self._values(rows, name, "current")
            changed = self._changes(CURRENT, current)
            if changed.size:
                arrows = current[changed] * ARROW_M_PER_M_S
                self._send(CURRENT, rows[changed], rr.Arrows3D.columns(vectors=arrows))

    def _changes(self, entity: str, values: NDArray[Any]) -> NDArray[np.intp]:
        """Which of the values (n, k) differ from those before them, in this batch or the last."""
        differ = np.ones(len(values), bool)
        differ[1:] = (values[1:] != values[:-1]).any(axis=1)
        if entity in self._shown:
            differ[0] = (values[0] != self._shown[entity]).any()
        self._shown[entity] = values[-1]
        return np.flatnonzero(differ)

    def _send_pose(self, entity: str, rows: Rows, channel: str) -> None:
        # Rerun wants xyzw, and both parts in one message: a part left out is reset.
        xyzw = self._values(rows, channel, "quaternion")[:, [1, 2, 3, 0]]
        position = self._values(rows, channel, "position")
        self._send(entity, rows, rr.Transform3D.columns(translation=position, quaternion=xyzw))

    def _draw_trail(self, entity: str, rows: Rows, position: NDArray[np.float64]) -> None:
        """Add a piece of trail for every tenth of a second."""
        tenths = np.floor(rows[:, 0] * _TRAIL_HZ)
        first_of_tenth = np.flatnonzero(np.diff(tenths, prepend=-1.0))
        ends = position[first_of_tenth]
        starts = np.vstack([self._trail_ends.setdefault(entity, ends[0]), ends[:-1]])
        strips = np.stack([starts, ends], axis=1).astype(np.float32)
        self._trail_ends[entity] = ends[-1]
        self._send(entity, rows[first_of_tenth], rr.LineStrips3D.columns(strips=strips))

    def _write_lane(self, lane: Lane, rows: Rows) -> None:
        codes = self._values(rows, lane.channel, lane.field)[:, lane.column]
        if lane.bounds:
            # A NaN is in no class, and stays one.
            codes = np.where(np.isfinite(codes), np.digitize(codes, lane.bounds), np.nan)
        # A NaN differs from everything, so no code is missed before the first one.
        before = self._lane_codes.get(lane.entity, np.nan)
        changes = np.flatnonzero(np.concatenate([[before], codes[:-1]]) != codes)
        self._lane_codes[lane.entity] = codes[-1]
        if changes.size:
            states = [str(int(code)) if np.isfinite(code) else "" for code in codes[changes]]
            self._send(lane.entity, rows[changes], rr.StateChange.columns(state=states))

    def _log_styles(self) -> None:
        if ("navigation", "position") in self._columns:
            log_estimate_styles(self._recording)
        for curve in self._curves:
            style = rr.SeriesLines(names=curve.names, colors=curve.colours, widths=[curve.width] * len(curve.names))
            self._recording.log(curve.entity, style, static=True)
        for lane in self._lanes:
            labels, colours = zip(*lane.states.values(), strict=True)
            values = [str(code) for code in lane.states]
            style = rr.StateConfiguration(values=values, labels=labels, colors=colours)
            self._recording.log(lane.entity, style, static=True)

    def _lay_out(self, batch: Batch) -> None:
        """Look at the whole path from where it can be seen: only the first batch knows where it is."""
        points = [np.empty((0, 3))]
        if "path" in batch.rows:
            points.append(self._values(batch.rows["path"][:1], "path", "points").reshape(-1, 3))
        if "pose" in batch.rows:
            points.append(self._values(batch.rows["pose"][:1], "pose", "position"))
        layout = blueprint(self._channels, np.vstack(points), self._boxes, self._duration_s)
        self._recording.send_blueprint(layout, make_active=True)

    def _values(self, rows: Rows, channel: str, field: str) -> NDArray[np.float64]:
        return rows[:, self._columns[channel, field]]

    def _send(self, entity: str, rows: NDArray[np.float64], columns: rr.ComponentColumnList) -> None:
        times = np.rint(rows[:, 0] * 1e9).astype("timedelta64[ns]")
        self._recording.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=times)], columns)


def _duration_s(header: RunHeader) -> float | None:
    """How long the run should last [s], if its scenario says so."""
    found = re.search(r"^duration_s: (\S+)$", header.resolved, re.MULTILINE)
    return None if found is None else float(found[1])


def _recording_id(header: RunHeader) -> str:
    """Derive the id from the inputs: a run made again is the same recording, another seed another one."""
    digest = hashlib.sha256()
    sources = [code.source for code in header.code]
    for part in (header.resolved, str(header.seed), *map(str, sorted(header.versions.items())), *sources):
        digest.update(part.encode() + b"\0")
    for name, content in sorted(header.inputs.items()):
        digest.update(name.encode() + b"\0" + content + b"\0")
    return digest.hexdigest()[:32]
