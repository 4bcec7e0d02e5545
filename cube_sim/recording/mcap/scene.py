"""What other programs' viewers draw: hull, path, trail, target and thrust, as the public schemas of foxglove.

Everything that stands still is one message of a topic: after a jump in time a viewer shows a topic's last message.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import Shape, thruster_mounts, vehicle_reach, vehicle_shapes
from cube_sim.recording.mcap.fixed_width import Layout
from cube_sim.recording.mcap.foxglove import WORLD_FRAME, frame_transform_layout
from cube_sim.recording.mcap.names import EPOCH_NS
from cube_sim.recording.mcap.pieces import (
    Fragment,
    Numbers,
    double,
    doubles,
    integer,
    layout_of,
    message,
    packed_fixed32,
    text,
    together,
)
from cube_sim.recording.mcap.schemas import FRAME_TRANSFORM, SCENE_UPDATE, frame_transform_schema, scene_update_schema

HULL_TOPIC, PATH_TOPIC, TRAIL_TOPIC = "/scene", "/scene/path", "/scene/trail"
THRUST_TOPIC, TARGET_TOPIC = "/scene/thrust", "/tf/target"
TARGET_FRAME = "target"

THRUST_HZ, TARGET_HZ = 10, 2
"""Between two places of a frame viewers go on evenly, between two scenes they do not."""

TRAIL_EVERY_S, TRAIL_S, TRAIL_POINTS = 5.0, 60.0, 61
"""How often the trail is drawn, how far back it reaches, and by how many points: a choice between sight and bytes."""

_FINENESS, _ARROW_FINENESS = 1024.0, 128.0
"""Numbers are drawn to this part of a metre, or of 1: what is rounded takes a third of the room."""

_LONGEST_ARROW = 4.0  # of the largest force, in multiples of the vehicle's reach
_LINE_STRIP, _LINE_LIST = 0, 2
_MARKER_M = 1.5
_ORANGE, _YELLOW, _PALE, _GREEN, _GREY = (
    (0.9, 0.62, 0.0, 1.0),
    (0.94, 0.89, 0.26, 1.0),
    (0.75, 0.8, 0.86, 1.0),
    (0.24, 1.0, 0.75, 1.0),
    (0.5, 0.54, 0.6, 1.0),
)


@dataclass(frozen=True)
class DrawnTopic:
    """A topic for viewers.

    Attributes:
        topic: its name.
        schema_name: of its messages.
        schema: their descriptor set.
        layout: of a message, its rows being those of `SceneRows`.
        seconds: where in a message the seconds of its stamp are written, or -1.
    """

    topic: str
    schema_name: str
    schema: bytes
    layout: Layout
    seconds: int = -1


class SceneRows:
    """Rows for the topics that viewers draw, made of the rows of a run.

    Attributes:
        topics: those there are, in the order in which they are declared.
        not_drawn: a line for each topic that there is not though the record has what it would show.
    """

    def __init__(
        self,
        channels: Sequence[Channel],
        model: mujoco.MjModel,
        vehicle: str | None,
        frame: str,
        target: str = TARGET_FRAME,
    ) -> None:
        """Lay the messages out.

        Args:
            channels: the channel table.
            model: the compiled model.
            vehicle: the body that swims; None for the first that can.
            frame: name of the vehicle's frame.
            target: name of the frame of its target.
        """
        self._columns = {
            (channel.name, field.name): columns
            for channel in channels
            for field, columns in zip(channel.fields, channel.columns, strict=True)
        }
        widths = {(channel.name, field.name): field.width for channel in channels for field in channel.fields}
        mounts = thruster_mounts(model, vehicle)
        self._reach = vehicle_reach(model, vehicle) or 0.5
        self._forward, self._backward = (_along(sign * mounts.axes) for sign in (1.0, -1.0))
        self._largest_N = 0.0
        self._begun, self._last, self._trail_due = False, dict[str, float](), 0.0
        self._trail: list[tuple[NDArray[np.float64], bool]] = []
        self._trail_s = 0.0
        hull = _hull(model, vehicle, frame, target, self._reach)
        scene = scene_update_schema()
        self.topics = [DrawnTopic(HULL_TOPIC, SCENE_UPDATE, scene, layout_of(hull, ()))]
        if ("path", "points") in widths:
            points = widths["path", "points"] // 3
            line = _line("path", _LINE_STRIP, points, 1.5, _PALE)
            self.topics.append(DrawnTopic(PATH_TOPIC, SCENE_UPDATE, scene, _counted(line)))
        if ("pose", "position") in widths:
            trail = _line("trail", _LINE_LIST, 2 * (TRAIL_POINTS - 1), 3.0, _YELLOW)
            self.topics.append(DrawnTopic(TRAIL_TOPIC, SCENE_UPDATE, scene, _counted(trail)))
        m, forces = len(mounts.names), widths.get(("thrusters", "force"), 0)
        self.not_drawn: tuple[str, ...] = ()
        if forces != m and forces:
            reason = f"the record has the forces of {forces} thrusters, the model has {m}"
            self.not_drawn = (f"{THRUST_TOPIC} is left out: {reason}",)
        elif m and forces:
            arrows = _arrows(mounts.positions, frame, self._reach)
            self.topics.append(DrawnTopic(THRUST_TOPIC, SCENE_UPDATE, scene, _counted(arrows)))
        if ("target", "position") in widths:
            layout, seconds = frame_transform_layout(target)
            self.topics.append(DrawnTopic(TARGET_TOPIC, FRAME_TRANSFORM, frame_transform_schema(), layout, seconds))
        declared = {drawn.topic for drawn in self.topics}
        made = (
            (PATH_TOPIC, "path", self._path),
            (TRAIL_TOPIC, "pose", self._trails),
            (THRUST_TOPIC, "thrusters", self._thrust),
            (TARGET_TOPIC, "target", self._target),
        )
        self._made = [each for each in made if each[0] in declared]

    def of(self, batch: Batch) -> Mapping[str, Rows]:
        """Rows of the topics that have any in this batch, by topic; column 0 is the time."""
        found: dict[str, Rows] = {}
        if not self._begun and batch.rows:
            self._begun = True
            found[HULL_TOPIC] = np.array([[min(float(rows[0, 0]) for rows in batch.rows.values())]])
        for topic, channel, rows_of in self._made:
            if channel in batch.rows:
                if "actuation" in batch.rows and not self._largest_N:
                    self._largest_N = self._largest(batch.rows["actuation"][:1])
                rows = rows_of(batch.rows[channel])
                if len(rows):
                    found[topic] = rows
        return found

    def _path(self, rows: Rows) -> Rows:
        return np.hstack([rows[:, :1], rows[:, self._columns["path", "points"]]])

    def _target(self, rows: Rows) -> Rows:
        rows = rows[self._steps(TARGET_TOPIC, rows, TARGET_HZ)]
        places = [self._columns["target", field] for field in ("position", "quaternion")]
        return np.hstack([rows[:, :1], *(_rounded(rows[:, place]) for place in places)])

    def _thrust(self, rows: Rows) -> Rows:
        """A row for each drawn instant: of each thruster the orientation of its arrow (x, y, z, w) and its length."""
        rows = rows[self._steps(THRUST_TOPIC, rows, THRUST_HZ)]
        force = rows[:, self._columns["thrusters", "force"]]
        scale = _LONGEST_ARROW * self._reach / (self._largest_N or 50.0)
        n, m = force.shape
        drawn = np.empty((n, 1 + 5 * m))
        drawn[:, 0], arrows = rows[:, 0], drawn[:, 1:].reshape(n, m, 5)
        arrows[:, :, :4] = np.where((force >= 0)[:, :, None], self._forward, self._backward)
        arrows[:, :, 4] = _rounded(np.abs(force) * scale, _ARROW_FINENESS)
        return drawn

    def _trails(self, rows: Rows) -> Rows:
        """A row whenever the trail is due: the ends of its pieces, the earliest first."""
        position = self._columns["pose", "position"]
        spacing = TRAIL_S / (TRAIL_POINTS - 1)
        made = []
        for row in rows[self._steps("spacing", rows, 1 / spacing)]:
            # After rows that were lost of a damaged record no piece leads to the next.
            apart = row[0] - self._trail_s > 1.5 * spacing
            self._trail_s = row[0]
            self._trail = [*self._trail[1 - TRAIL_POINTS :], (row[position], apart)]
            if row[0] >= self._trail_due:
                self._trail_due = row[0] + TRAIL_EVERY_S
                whole = [self._trail[0]] * (TRAIL_POINTS - len(self._trail)) + self._trail
                points, broken = np.array([point for point, _ in whole]), np.array([off for _, off in whole])
                starts = np.where(broken[1:, None], points[1:], points[:-1])
                made.append(np.concatenate([row[:1], _rounded(np.stack([starts, points[1:]], axis=1).ravel())]))
        return np.array(made)

    def _steps(self, what: str, rows: Rows, hz: float) -> NDArray[np.intp]:
        """Which rows are the first of their step, whatever batches they come in."""
        steps = np.empty(1 + len(rows))
        steps[0] = self._last.get(what, -1.0)
        np.floor(rows[:, 0] * hz + 1e-6, out=steps[1:])
        self._last[what] = float(steps[-1])
        return np.flatnonzero(steps[1:] > steps[:-1])

    def _largest(self, rows: Rows) -> float:
        limits = np.abs(rows[:, self._columns["actuation", "limits"]])
        return float(limits[np.isfinite(limits)].max(initial=0.0))


def _rounded(numbers: NDArray[np.float64], fineness: float = _FINENESS) -> NDArray[np.float64]:
    return np.round(numbers * fineness) / fineness


def _counted(piece: Fragment) -> Layout:
    """A layout whose numbers stand in a row as in the message."""
    return layout_of(piece, range(1, 1 + len(piece.slots)))


def _entity(name: str, frame: str, *pieces: Fragment) -> Fragment:
    """An entity that goes along with its frame until one of the same name takes its place."""
    seconds, nanoseconds = divmod(EPOCH_NS, 1_000_000_000)
    stamp = message(1, integer(1, seconds), integer(2, nanoseconds))
    return message(2, stamp, text(2, frame), text(3, name), integer(5, 1), *pieces)


def _pose(position: Numbers, xyzw: Numbers | None) -> Fragment:
    return message(1, message(1, doubles(position, 3)), message(2, doubles(xyzw, 4)))


def _colour(number: int, rgba: Numbers) -> Fragment:
    return message(number, doubles(rgba, 4))


def _line(name: str, kind: int, points: int, pixels: float, rgba: Numbers) -> Fragment:
    """Points that change, joined, in world axes."""
    pose = message(2, message(1, doubles((0, 0, 0), 3)), message(2, doubles((0, 0, 0, 1), 4)))
    ends = (message(5, doubles(None, 3)) for _ in range(points))
    line = message(11, integer(1, kind), pose, double(3, pixels), integer(4, 1), *ends, _colour(6, rgba))
    return _entity(name, WORLD_FRAME, line)


def _arrows(positions: NDArray[np.float64], frame: str, reach: float) -> Fragment:
    return _entity("thrust", frame, *(_arrow(position, None, None, reach, _ORANGE) for position in positions))


def _arrow(
    position: Numbers,
    xyzw: Numbers | None,
    length: float | None,
    reach: float,
    rgba: Numbers,
) -> Fragment:
    shape = (double(2, length), double(3, 0.05 * reach), double(4, 0.15 * reach), double(5, 0.12 * reach))
    return message(7, _pose(position, xyzw), *shape, _colour(6, rgba))


def _hull(model: mujoco.MjModel, vehicle: str | None, frame: str, target: str, reach: float) -> Fragment:
    """Shapes and thrusters in the vehicle's frame, and an arrow along the path in the target's."""
    shapes = [_shape(model, shape) for shape in vehicle_shapes(model, vehicle)]
    mounts = thruster_mounts(model, vehicle)
    size = 0.2 * reach
    ducts = [
        _cylinder(position, frame_, (size, size, 0.5 * size), _GREY)
        for position, frame_ in zip(mounts.positions, mounts.rotations, strict=True)
    ]
    hull = _entity("hull", frame, *(shape for shape in shapes if shape is not None), *ducts)
    marker = _arrow((0, 0, 0), (0, 0, 0, 1), max(_MARKER_M, 1.7 * reach), reach, _GREEN)
    return together((hull, _entity("target", target, marker)))


def _shape(model: mujoco.MjModel, shape: Shape) -> Fragment | None:
    """A geom as a primitive; None where there is none like it."""
    geom, x, xyzw = mujoco.mjtGeom, shape.size, _xyzw(shape.rotation)
    pose, colour = _pose(shape.position, xyzw), shape.rgba
    if shape.kind == geom.mjGEOM_BOX:
        return message(8, pose, message(2, doubles(2 * x, 3)), _colour(3, colour))
    if shape.kind in (geom.mjGEOM_SPHERE, geom.mjGEOM_ELLIPSOID):
        size = 2 * (np.repeat(x[0], 3) if shape.kind == geom.mjGEOM_SPHERE else x)
        return message(9, pose, message(2, doubles(size, 3)), _colour(3, colour))
    if shape.kind in (geom.mjGEOM_CYLINDER, geom.mjGEOM_CAPSULE):
        length = 2 * (x[1] + (x[0] if shape.kind == geom.mjGEOM_CAPSULE else 0.0))
        return _cylinder(shape.position, shape.rotation, (2 * x[0], 2 * x[0], length), colour)
    if shape.mesh >= 0:
        first, count = model.mesh_vertadr[shape.mesh], model.mesh_vertnum[shape.mesh]
        face, faces = model.mesh_faceadr[shape.mesh], model.mesh_facenum[shape.mesh]
        points = (message(2, doubles(point, 3)) for point in model.mesh_vert[first : first + count])
        corners = packed_fixed32(5, model.mesh_face[face : face + faces].ravel())
        return message(12, pose, *points, _colour(3, colour), corners)
    return None


def _cylinder(position: Numbers, rotation: NDArray[np.float64], size: Numbers, rgba: Numbers) -> Fragment:
    pose, ends = _pose(position, _xyzw(rotation)), (double(3, 1.0), double(4, 1.0))
    return message(10, pose, message(2, doubles(size, 3)), *ends, _colour(5, rgba))


def _xyzw(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    wxyz = np.empty(4)
    mujoco.mju_mat2Quat(wxyz, np.ascontiguousarray(rotation).ravel())
    return wxyz[[1, 2, 3, 0]]


def _along(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotations (m, 4) xyzw that turn the x axis to each unit vector (m, 3)."""
    found = np.empty((len(axes), 4))
    for row, axis in zip(found, axes, strict=True):
        w = 1.0 + axis[0]
        turn = np.array([0.0, -axis[2], axis[1], w]) if w > 1e-9 else np.array([0.0, 0.0, 1.0, 0.0])
        row[:] = turn / np.linalg.norm(turn)
    return found
