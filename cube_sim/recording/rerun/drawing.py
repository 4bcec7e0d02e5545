"""A run drawn into a Rerun recording, batch by batch: the one way from recorded numbers to what is seen."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import mujoco
import numpy as np
import rerun as rr
from numpy.typing import NDArray

from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.geometry import thruster_mounts
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.carried import CarriedDrawing
from cube_sim.recording.rerun.drawn import Drawn
from cube_sim.recording.rerun.ending import ending_text
from cube_sim.recording.rerun.gaps import Gaps
from cube_sim.recording.rerun.guides import log_guides
from cube_sim.recording.rerun.parts import Parts
from cube_sim.recording.rerun.plots import AT_LIMIT, HEALTH_BOUNDS, Curves, Lane, curves, lanes
from cube_sim.recording.rerun.scene import PATH_POINTS, log_estimate_styles, log_scene, log_surface
from cube_sim.recording.run_end import RunEnd

TIMELINE = "sim_time"
_TRAIL_HZ = 10
_LEVELS = {"WARNING": "WARN", "FATAL": "CRITICAL"}  # where the viewer has another word
_AT_LIMIT_SHARE = 1e-3  # a force this near to a limit, as a share of it, counts as at the limit (choice)
_WHOLE = 2
_DOT = 2.0  # points


class RunDrawing:
    """Draws one run; what it draws depends on the batches, the channel table, the story and the model alone."""

    def __init__(self, recording: rr.RecordingStream, drawn: Drawn, model: mujoco.MjModel, vehicle: str | None) -> None:
        """Draw what stands still.

        Args:
            recording: into which.
            drawn: what is known of the run.
            model: the compiled model.
            vehicle: the body that swims; None for the first that can.
        """
        self._recording, self._places, self._look, self._measures = recording, drawn.places, drawn.look, drawn.measures
        self._columns = {
            (channel.name, field.name): columns
            for channel in drawn.channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }
        self._curves = curves(drawn.channels)
        self._lanes = lanes(drawn.channels)
        self._lane_codes: dict[str, float] = {}
        self._shown: dict[str, NDArray[Any]] = {}
        self._gaps = Gaps(drawn.channels)
        self._trail_ends: dict[str, NDArray[np.float64]] = {}
        self._limits: Rows | None = None
        self._parts = Parts(recording, drawn.places)
        mounts = thruster_mounts(model, vehicle)
        self._axes, self._thrusters = mounts.axes, mounts.names
        log_scene(recording, model, vehicle, drawn.places, drawn.measures, drawn.look, self._parts)
        recorded = ("joints", "position") in self._columns
        self._carried = CarriedDrawing(recording, model, vehicle, drawn.places, self._parts, recorded)
        if mounts.moving:
            moving = f"{', '.join(mounts.moving)}: on what moves on the hull, drawn in its reference pose"
            recording.log(f"{self._places.log}/model/moving thrusters", rr.TextLog(moving, level="WARN"), static=True)
        if ("health", "efficiency") not in self._columns and mounts.names:
            healthy = rr.Cylinders3D.from_fields(colors=[palette.DUCT], labels=mounts.names)
            recording.log(self._places.thrusters, healthy, static=True)
        if len(drawn.points) and drawn.look.surface:
            log_surface(recording, drawn.places, drawn.points.min(axis=0), drawn.points.max(axis=0))
        self._log_styles()
        self._parts.draw("limits and events", lambda: log_guides(recording, drawn, self._curves, TIMELINE))
        self._story = drawn.story.text
        self._show_text(self._story)

    def tell(self, end: RunEnd) -> None:
        """Show how the run ended, above what its scenario says."""
        self._show_text("\n\n".join(part for part in (ending_text(end), self._story) if part))

    def _show_text(self, text: str) -> None:
        if text:
            document = rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN)
            self._recording.log(self._places.scenario, document, static=True)

    def write(self, batch: Batch) -> None:
        """Draw the next batch."""
        if "actuation" in batch.rows and ("actuation", "limits") in self._columns:
            rows = batch.rows["actuation"]
            self._limits = rows if self._limits is None else np.concatenate([self._limits[-1:], rows])
        for name, rows in batch.rows.items():
            self._parts.draw(name, partial(self._draw, name, rows))
        broken = {name: self._gaps.broken(name, rows) for name, rows in batch.rows.items()}
        if "pose" in broken:
            self._parts.draw("trail", partial(self._draw_trail, self._places.trail, broken["pose"], "pose"))
        if "navigation" in broken:
            trail = partial(self._draw_trail, self._places.estimate_trail, broken["navigation"], "navigation")
            self._parts.draw("trail of the estimate", trail)
        for curve in self._curves:
            if curve.channel in broken:
                self._parts.draw(curve.entity, partial(self._write_curve, curve, broken[curve.channel]))
        for lane in self._lanes:
            if lane.channel in batch.rows:
                self._parts.draw(lane.entity, partial(self._write_lane, lane, batch, broken[lane.channel][:, 0]))
        if batch.log:
            t = np.array([[line.t] for line in batch.log])
            text, level = [line.text for line in batch.log], [_LEVELS.get(line.level, line.level) for line in batch.log]
            self._send(self._places.log, t, rr.TextLog.columns(text=text, level=level))

    def _log_styles(self) -> None:
        places, name = self._places, self._look.name
        if ("navigation", "position") in self._columns:
            log_estimate_styles(self._recording, places)
        for curve in self._curves:
            names = [f"{name}: {each}" if name else each for each in curve.names]
            if curve.dots:
                style = rr.SeriesPoints(names=names, colors=curve.colours, marker_sizes=[_DOT] * len(names))
            else:
                style = rr.SeriesLines(names=names, colors=curve.colours, widths=[curve.width] * len(names))
            self._recording.log(places.at(curve.entity), style, static=True)
        for lane in self._lanes:
            labels, colours = zip(*lane.states.values(), strict=True)
            values = [str(code) for code in lane.states]
            style = rr.StateConfiguration(values=values, labels=labels, colors=colours)
            self._recording.log(places.at(lane.entity), style, static=True)

    def _draw(self, name: str, rows: Rows) -> None:
        """Draw in 3-D what a channel has to show there."""
        if name == "pose":
            position = self._values(rows, name, "position")
            self._send_pose(self._places.vehicle, rows, name)
            # The arrow of the current goes along with the vehicle.
            self._send(self._places.current, rows, rr.Transform3D.columns(translation=position))
        elif name == "navigation":
            position, sigma = (self._values(rows, name, field) for field in ("position", "position_sigma"))
            self._send(self._places.estimate, rows, rr.Ellipsoids3D.columns(centers=position, half_sizes=2.0 * sigma))
        elif name == "target":
            self._send_pose(self._places.target, rows, name)
        elif name == "path":
            points = self._values(rows, name, "points").astype(np.float32).reshape(len(rows), -1, 3)
            # Negative: points of the screen.
            colours, radii = [self._look.path] * len(rows), np.full(len(rows), -PATH_POINTS)
            self._send(self._places.path, rows, rr.LineStrips3D.columns(strips=points, colors=colours, radii=radii))
        elif name == "thrusters":
            force = self._values(rows, name, "force")
            m, thrust = len(self._axes), self._places.thrust
            if force.shape[1] != m:
                raise ValueError(f"the record has the forces of {force.shape[1]} thrusters, the model has {m}")
            if not m:
                return
            arrows = force[:, :, None] * self._axes * self._measures.arrow_m_per_N
            self._send(thrust, rows, rr.Arrows3D.columns(vectors=arrows.reshape(-1, 3)).partition([m] * len(rows)))
            # What is not sent stays as it was shown last.
            turned = self._changes(thrust, force >= 0.0)
            colours = palette.by_sign(force[turned].ravel())
            if turned.size:
                self._send(thrust, rows[turned], rr.Arrows3D.columns(colors=colours).partition([m] * len(turned)))
        elif name == "water":
            current = self._values(rows, name, "current")
            changed = self._changes(self._places.current, current)
            if changed.size:
                arrows = current[changed] * self._measures.arrow_m_per_m_s
                self._send(self._places.current, rows[changed], rr.Arrows3D.columns(vectors=arrows))
        elif name == "joints":
            for entity, placed in self._carried.placed(self._values(rows, name, "position")):
                self._send(entity, rows, placed)
        elif name == "health":
            self._mark_thrusters(rows)
        elif name == "sensor_position" and ("sensor_position", "position") in self._columns:
            fixes = self._values(rows, name, "position")
            self._send(self._places.fixes, rows, rr.Points3D.columns(positions=fixes))

    def _mark_thrusters(self, rows: Rows) -> None:
        """Thrusters that give less than they should, in another colour, and by name those that the controller knows."""
        true, believed = (self._values(rows, "health", field) for field in ("efficiency", "believed"))
        m = len(self._thrusters)
        if not m or true.shape[1] != m:
            return
        classes = np.hstack([_health(true), _health(believed)])
        turned = self._changes(self._places.thrusters, classes)
        if turned.size:
            colours = np.array([palette.BAD, palette.ORANGE, palette.DUCT], np.uint8)[classes[turned, :m]]
            labels = [_marked(self._thrusters, row[:m], row[m:]) for row in classes[turned]]
            columns = rr.Cylinders3D.columns(colors=colours.reshape(-1, 3), labels=np.concatenate(labels))
            self._send(self._places.thrusters, rows[turned], columns.partition([m] * len(turned)))

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

    def _draw_trail(self, entity: str, rows: Rows, channel: str) -> None:
        """Add a piece of trail for every tenth of a second; none across a row of NaN."""
        position = self._values(rows, channel, "position")
        tenths = np.floor(rows[:, 0] * _TRAIL_HZ)
        first_of_tenth = np.flatnonzero((np.diff(tenths, prepend=-1.0) > 0) | np.isnan(position[:, 0]))
        ends = position[first_of_tenth]
        starts = np.vstack([self._trail_ends.setdefault(entity, ends[0]), ends[:-1]])
        strips = np.stack([starts, ends], axis=1).astype(np.float32)
        self._trail_ends[entity] = ends[-1]
        known = np.isfinite(strips).all(axis=(1, 2))
        if known.any():
            self._send(entity, rows[first_of_tenth[known]], rr.LineStrips3D.columns(strips=strips[known]))

    def _write_curve(self, curve: Curves, rows: Rows) -> None:
        values = curve.values(self._values(rows, curve.channel, curve.field))
        scalars = rr.Scalars.columns(scalars=np.ascontiguousarray(values).ravel())
        n, entity = values.shape[1], self._places.at(curve.entity)
        self._send(entity, rows, scalars if n == 1 else scalars.partition([n] * len(rows)))

    def _write_lane(self, lane: Lane, batch: Batch, times: NDArray[np.float64]) -> None:
        """Tell changes of a state, at the times of its rows and of those that are missing."""
        rows = batch.rows[lane.channel]
        codes = self._values(rows, lane.channel, lane.field)[:, lane.column]
        if lane.thruster is not None:
            codes = self._with_limits(codes, rows[:, 0], batch, lane.thruster)
        if lane.bounds:
            # A NaN is in no class, and stays one.
            codes = np.where(np.isfinite(codes), np.digitize(codes, lane.bounds), np.nan)
        if len(times) > len(codes):
            recorded = codes
            codes = np.full(len(times), np.nan)
            codes[np.isin(times, rows[:, 0])] = recorded
        # A NaN differs from everything, so no code is missed before the first one.
        before = self._lane_codes.get(lane.entity, np.nan)
        changes = np.flatnonzero(np.concatenate([[before], codes[:-1]]) != codes)
        self._lane_codes[lane.entity] = codes[-1]
        if changes.size:
            states = [str(int(code)) if np.isfinite(code) else "" for code in codes[changes]]
            self._send(self._places.at(lane.entity), times[changes, None], rr.StateChange.columns(state=states))

    def _with_limits(
        self, codes: NDArray[np.float64], times: NDArray[np.float64], batch: Batch, thruster: int
    ) -> NDArray[np.float64]:
        """Sides of the dead zone, -1, 0 or +1, twice that where the force asked for is at its limit."""
        forces = batch.rows.get("thrusters")
        if forces is None or self._limits is None or not np.array_equal(forces[:, 0], times):
            return codes
        force = self._values(forces, "thrusters", "force_demanded")[:, thruster]
        held = np.maximum(np.searchsorted(self._limits[:, 0], times, side="right") - 1, 0)
        limits = self._values(self._limits, "actuation", "limits")[held]
        lowest, highest = limits[:, 4 * thruster], limits[:, 4 * thruster + 3]
        at_limit = ((lowest < 0) & (force <= (1 - _AT_LIMIT_SHARE) * lowest)) | (
            (highest > 0) & (force >= (1 - _AT_LIMIT_SHARE) * highest)
        )
        return np.where(at_limit & (force != 0), AT_LIMIT * np.sign(force), codes)

    def _values(self, rows: Rows, channel: str, field: str) -> NDArray[np.float64]:
        return rows[:, self._columns[channel, field]]

    def _send(self, entity: str, rows: NDArray[np.float64], columns: rr.ComponentColumnList) -> None:
        times = np.rint(rows[:, 0] * 1e9).astype("timedelta64[ns]")
        self._recording.send_columns(entity, [rr.TimeColumn(TIMELINE, duration=times)], columns)


def _health(shares: NDArray[np.float64]) -> NDArray[np.intp]:
    """0 where nothing of a thruster's force is left, 1 where some is, 2 where all is; 2 where nobody knows."""
    return np.where(np.isfinite(shares), np.digitize(shares, HEALTH_BOUNDS), 2)


def _marked(names: Sequence[str], true: NDArray[np.intp], believed: NDArray[np.intp]) -> list[str]:
    """Labels of thrusters by their health, and by what the controller takes it for."""
    return [f"{name} {_mark(*both)}".strip() for name, *both in zip(names, true, believed, strict=True)]


def _mark(true: int, believed: int) -> str:
    said = ("dead", "weak", "whole")
    if true == believed:
        return "" if true == _WHOLE else said[true]
    return f"{said[true]}, taken for {said[believed]}"
