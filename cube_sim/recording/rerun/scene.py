"""What stands still in the Rerun view: the shapes of the model, the thrusters, styles and names of curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import inf

import mujoco
import numpy as np
import rerun as rr
from numpy.typing import NDArray

from cube_sim.recording.geometry import (
    Shape,
    ThrusterMounts,
    thruster_mounts,
    vehicle_shapes,
    world_shapes,
)
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.parts import Parts
from cube_sim.recording.rerun.places import Places

ARROW_M_PER_M_S = 14.0
"""Length of the arrow of the current, in multiples of the vehicle's reach per m/s."""

TRAIL_POINTS, PATH_POINTS = 1.5, 1.0
"""Radii of lines that are seen from any distance, on the screen."""

_USUAL_THRUST = 1.6
"""Length of the arrow of a usual force, in multiples of the vehicle's reach."""

_SMALLEST_USUAL = 0.1
"""A usual force is taken for no less than this share of the largest, so that idling is not drawn as work."""

_DUCT_RADIUS, _DUCT_HALF_LENGTH = 0.045, 0.02  # where a site has no size [m]
_MARKER_M, _MARKER_POINTS = 1.5, 3.0  # length in the world, radius on the screen
_NET = 7  # lines each way
_ENDLESS_PLANE = 30.0  # half size [m] by which a plane without an end is drawn


@dataclass(frozen=True)
class Look:
    """How one run looks beside another in the same scene.

    Attributes:
        trail: colour of its trail.
        path: colour of its path.
        name: shown at the vehicle; "" where it is alone.
        surface: whether the sea surface is drawn with it.
        surroundings: whether what stands still around it is drawn with it.
    """

    trail: palette.Rgb = palette.TRAIL
    path: palette.Rgb = palette.PATH
    name: str = ""
    surface: bool = True
    surroundings: bool = True


@dataclass(frozen=True)
class Measures:
    """How large things are drawn.

    Attributes:
        reach: of the vehicle [m]; what is drawn at it grows with it.
        largest_N: largest force of a thruster.
        arrow_m_per_N: length of a thrust arrow.
        arrow_m_per_m_s: length of the arrow of the current.
    """

    reach: float
    largest_N: float  # noqa: N815 - N is the newton
    arrow_m_per_N: float  # noqa: N815 - N is the newton
    arrow_m_per_m_s: float

    @classmethod
    def of(cls, reach: float, largest_N: float, usual_N: float = 0.0) -> Measures:
        """Choose by how far a vehicle reaches [m], by the largest force of a thruster and by a usual one [N]."""
        reach = reach if reach > 0 else 0.5
        largest_N = largest_N if 0 < largest_N < inf else 50.0
        usual_N = min(max(usual_N, _SMALLEST_USUAL * largest_N), largest_N)
        return cls(reach, largest_N, _USUAL_THRUST * reach / usual_N, ARROW_M_PER_M_S * reach)


def log_scene(
    recording: rr.RecordingStream,
    model: mujoco.MjModel,
    vehicle: str | None,
    places: Places,
    measures: Measures,
    look: Look,
    parts: Parts,
) -> None:
    """Draw what the model alone says.

    Args:
        recording: into which.
        model: the compiled model.
        vehicle: the body that swims; None for the first that can.
        places: where.
        measures: how large.
        look: how it looks.
        parts: what is left out where it cannot be drawn.
    """
    reach = measures.reach
    recording.log(places.world, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for shape in world_shapes(model) if look.surroundings else ():
        solid = rr.components.FillMode.Solid
        parts.draw(shape.name, partial(log_shape, recording, f"{places.world}/surroundings", model, shape, solid))
    see_through = rr.components.FillMode.TransparentFillMajorWireframe
    for shape in vehicle_shapes(model, vehicle):
        parts.draw(shape.name, partial(log_shape, recording, f"{places.vehicle}/body", model, shape, see_through))
    mounts = thruster_mounts(model, vehicle)
    _log_ducts(recording, mounts, places)
    recording.log(
        places.thrust,
        rr.Arrows3D.from_fields(origins=mounts.positions, radii=[0.033 * reach] * len(mounts.names)),
        static=True,
    )
    recording.log(f"{places.vehicle}/axes", rr.TransformAxes3D(1.05 * reach), static=True)
    if look.name:
        label = rr.Points3D([[0, 0, 1.2 * reach]], radii=[0.0], colors=[look.trail], labels=[look.name])
        recording.log(f"{places.vehicle}/name", label, static=True)
    recording.log(
        places.trail,
        rr.LineStrips3D.from_fields(colors=[look.trail], radii=rr.Radius.ui_points(TRAIL_POINTS)),
        static=True,
    )
    recording.log(places.current, rr.Arrows3D.from_fields(colors=[palette.CURRENT], radii=[0.042 * reach]), static=True)
    # Long enough to be seen from afar, and when the vehicle sits on the target.
    marker = rr.Arrows3D(
        vectors=[[max(_MARKER_M, 1.7 * reach), 0, 0]],
        colors=[palette.TARGET],
        radii=rr.Radius.ui_points(_MARKER_POINTS),
        labels=["virtual target"],
        show_labels=not look.name,
    )
    recording.log(f"{places.target}/tangent", marker, static=True)
    recording.log(f"{places.target}/frame", rr.TransformAxes3D(max(0.5, 0.5 * reach)), static=True)


def log_surface(
    recording: rr.RecordingStream, places: Places, low: NDArray[np.float64], high: NDArray[np.float64]
) -> None:
    """Draw the sea surface over what is in sight as a net, which hides nothing below it.

    Args:
        recording: into which.
        places: where.
        low: (3,) corner of what is in sight, world axes [m].
        high: (3,) the corner opposite.
    """
    margin = max(1.0, 0.25 * float((high - low)[:2].max()))
    xs, ys = (np.linspace(low[i] - margin, high[i] + margin, _NET) for i in (0, 1))
    along = [[[x, ys[0], 0.0], [x, ys[-1], 0.0]] for x in xs]
    across = [[[xs[0], y, 0.0], [xs[-1], y, 0.0]] for y in ys]
    net = rr.LineStrips3D(
        along + across,
        colors=[palette.SURFACE],
        radii=rr.Radius.ui_points(0.5),
        labels=["sea surface"] + [""] * (2 * _NET - 1),
        show_labels=False,
    )
    recording.log(places.surface, net, static=True)
    corner = rr.Points3D([[xs[0], ys[-1], 0.0]], radii=[0.0], colors=[palette.SURFACE], labels=["sea surface, z = 0"])
    recording.log(f"{places.surface}/name", corner, static=True)


def log_estimate_styles(recording: rr.RecordingStream, places: Places) -> None:
    """How a navigation estimate looks: its trail, and where the vehicle may be."""
    colours = [palette.ESTIMATE]
    recording.log(
        places.estimate_trail,
        rr.LineStrips3D.from_fields(colors=colours, radii=rr.Radius.ui_points(PATH_POINTS)),
        static=True,
    )
    recording.log(
        places.fixes, rr.Points3D.from_fields(colors=[palette.PURPLE], radii=rr.Radius.ui_points(2.0)), static=True
    )
    wires = rr.components.FillMode.MajorWireframe
    recording.log(places.estimate, rr.Ellipsoids3D.from_fields(colors=colours, fill_mode=wires), static=True)


def _log_ducts(recording: rr.RecordingStream, mounts: ThrusterMounts, places: Places) -> None:
    if not mounts.names:
        return
    sized = mounts.sizes[:, 1] > 0
    recording.log(
        places.thrusters,
        # Colours and labels change when a thruster fails: what is static would hide that.
        rr.Cylinders3D.from_fields(
            centers=mounts.positions,
            radii=np.where(sized, mounts.sizes[:, 0], _DUCT_RADIUS),
            lengths=2 * np.where(sized, mounts.sizes[:, 1], _DUCT_HALF_LENGTH),
            quaternions=[_xyzw(frame) for frame in mounts.rotations],
            fill_mode=rr.components.FillMode.Solid,
            show_labels=False,
        ),
        static=True,
    )


def log_shape(
    recording: rr.RecordingStream,
    parent: str,
    model: mujoco.MjModel,
    shape: Shape,
    fill: rr.components.FillMode,
) -> None:
    """Draw one shape.

    Args:
        recording: into which.
        parent: entity in whose axes it stands.
        model: the compiled model.
        shape: of it.
        fill: how.

    Raises:
        ValueError: there is nothing like it to draw.
    """
    geom = mujoco.mjtGeom
    colours = [palette.rgba8(shape.rgba)]
    placed = {"quaternions": [_xyzw(shape.rotation)], "colors": colours, "fill_mode": fill}
    centre = [shape.position]
    if shape.kind == geom.mjGEOM_BOX:
        drawn = rr.Boxes3D(half_sizes=[shape.size], centers=centre, **placed)
    elif shape.kind == geom.mjGEOM_PLANE:
        half = [*np.where(shape.size[:2] > 0, shape.size[:2], _ENDLESS_PLANE), 1e-3]
        drawn = rr.Boxes3D(half_sizes=[half], centers=centre, **placed)
    elif shape.kind == geom.mjGEOM_SPHERE:
        drawn = rr.Ellipsoids3D(half_sizes=[np.repeat(shape.size[0], 3)], centers=centre, **placed)
    elif shape.kind == geom.mjGEOM_ELLIPSOID:
        drawn = rr.Ellipsoids3D(half_sizes=[shape.size], centers=centre, **placed)
    elif shape.kind == geom.mjGEOM_CYLINDER:
        drawn = rr.Cylinders3D(radii=[shape.size[0]], lengths=[2 * shape.size[1]], centers=centre, **placed)
    elif shape.kind == geom.mjGEOM_CAPSULE:
        # Rerun's capsule starts at its origin, MuJoCo's has it in the middle.
        start = shape.position - shape.rotation[:, 2] * shape.size[1]
        drawn = rr.Capsules3D(radii=[shape.size[0]], lengths=[2 * shape.size[1]], translations=[start], **placed)
    elif shape.mesh >= 0:
        vertices, faces = _mesh(model, shape)
        drawn = rr.Mesh3D(vertex_positions=vertices, triangle_indices=faces, albedo_factor=colours[0])
    else:
        raise ValueError(f"its type is {shape.kind.name}")
    recording.log(f"{parent}/{shape.name}", drawn, static=True)


def _mesh(model: mujoco.MjModel, shape: Shape) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    first, count = model.mesh_vertadr[shape.mesh], model.mesh_vertnum[shape.mesh]
    face, faces = model.mesh_faceadr[shape.mesh], model.mesh_facenum[shape.mesh]
    vertices = model.mesh_vert[first : first + count] @ shape.rotation.T + shape.position
    return vertices.astype(np.float32), model.mesh_face[face : face + faces].copy()


def _xyzw(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    wxyz = np.empty(4)
    mujoco.mju_mat2Quat(wxyz, np.ascontiguousarray(matrix).ravel())
    return wxyz[[1, 2, 3, 0]]
