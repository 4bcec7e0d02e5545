"""What stands still in the Rerun view: the shapes of the model, the thrusters, styles and names of curves."""

from __future__ import annotations

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

WORLD = "/world"
VEHICLE = f"{WORLD}/vehicle"
THRUST = f"{VEHICLE}/thrust"
PATH = f"{WORLD}/path"
TRAIL = f"{WORLD}/trail"
ESTIMATE = f"{WORLD}/estimate"
ESTIMATE_TRAIL = f"{ESTIMATE}/trail"
TARGET = f"{WORLD}/target"
CURRENT = f"{WORLD}/current"
LOG = "/log"

ARROW_M_PER_N = 0.04
ARROW_M_PER_M_S = 6.0

_DUCT_RADIUS, _DUCT_HALF_LENGTH = 0.045, 0.02  # where a site has no size [m]
_MARKER_M, _MARKER_POINTS = 1.5, 3.0  # length in the world, radius on the screen
_ENDLESS_PLANE = 30.0  # half size [m] by which a plane without an end is drawn


def log_scene(recording: rr.RecordingStream, model: mujoco.MjModel, vehicle: str | None = None) -> list[str]:
    """Draw what the model alone says.

    Args:
        recording: into which.
        model: the compiled model.
        vehicle: the body that swims; None for the first that can.

    Returns:
        Rerun paths of the boxes the vehicle is made of.
    """
    recording.log(WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for shape in world_shapes(model):
        _log_shape(recording, f"{WORLD}/surroundings/{shape.name}", model, shape, rr.components.FillMode.Solid)
    see_through = rr.components.FillMode.TransparentFillMajorWireframe
    for shape in vehicle_shapes(model, vehicle):
        _log_shape(recording, f"{VEHICLE}/body/{shape.name}", model, shape, see_through)
    mounts = thruster_mounts(model, vehicle)
    _log_ducts(recording, mounts)
    recording.log(
        THRUST, rr.Arrows3D.from_fields(origins=mounts.positions, radii=[0.014] * len(mounts.names)), static=True
    )
    recording.log(f"{VEHICLE}/axes", rr.TransformAxes3D(0.45), static=True)
    recording.log(TRAIL, rr.LineStrips3D.from_fields(colors=[palette.TRAIL], radii=[0.03]), static=True)
    recording.log(CURRENT, rr.Arrows3D.from_fields(colors=[palette.CURRENT], radii=[0.018]), static=True)
    # Long enough to be seen from afar, and when the vehicle sits on the target.
    marker = rr.Arrows3D(
        vectors=[[_MARKER_M, 0, 0]],
        colors=[palette.TARGET],
        radii=rr.Radius.ui_points(_MARKER_POINTS),
        labels=["virtual target"],
        show_labels=True,
    )
    recording.log(f"{TARGET}/tangent", marker, static=True)
    recording.log(f"{TARGET}/frame", rr.TransformAxes3D(0.5), static=True)
    box = mujoco.mjtGeom.mjGEOM_BOX
    return [f"{VEHICLE}/body/{shape.name}" for shape in vehicle_shapes(model, vehicle) if shape.kind == box]


def log_estimate_styles(recording: rr.RecordingStream) -> None:
    """How a navigation estimate looks: its trail, and where the vehicle may be."""
    colours = [palette.ESTIMATE]
    recording.log(ESTIMATE_TRAIL, rr.LineStrips3D.from_fields(colors=colours, radii=[0.02]), static=True)
    wires = rr.components.FillMode.MajorWireframe
    recording.log(ESTIMATE, rr.Ellipsoids3D.from_fields(colors=colours, fill_mode=wires), static=True)


def _log_ducts(recording: rr.RecordingStream, mounts: ThrusterMounts) -> None:
    if not mounts.names:
        return
    sized = mounts.sizes[:, 1] > 0
    recording.log(
        f"{VEHICLE}/thrusters",
        rr.Cylinders3D(
            centers=mounts.positions,
            radii=np.where(sized, mounts.sizes[:, 0], _DUCT_RADIUS),
            lengths=2 * np.where(sized, mounts.sizes[:, 1], _DUCT_HALF_LENGTH),
            quaternions=[_xyzw(frame) for frame in mounts.rotations],
            colors=[palette.DUCT],
            fill_mode=rr.components.FillMode.Solid,
            labels=mounts.names,
            show_labels=False,
        ),
        static=True,
    )


def _log_shape(
    recording: rr.RecordingStream,
    entity: str,
    model: mujoco.MjModel,
    shape: Shape,
    fill: rr.components.FillMode,
) -> None:
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
        # Beside the log and not in it: what is static hides what comes later.
        message = rr.TextLog(f"{shape.name} is not drawn: its type is {shape.kind.name}", level="WARN")
        recording.log(f"{LOG}/model/{shape.name}", message, static=True)
        return
    recording.log(entity, drawn, static=True)


def _mesh(model: mujoco.MjModel, shape: Shape) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    first, count = model.mesh_vertadr[shape.mesh], model.mesh_vertnum[shape.mesh]
    face, faces = model.mesh_faceadr[shape.mesh], model.mesh_facenum[shape.mesh]
    vertices = model.mesh_vert[first : first + count] @ shape.rotation.T + shape.position
    return vertices.astype(np.float32), model.mesh_face[face : face + faces].copy()


def _xyzw(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    wxyz = np.empty(4)
    mujoco.mju_mat2Quat(wxyz, np.ascontiguousarray(matrix).ravel())
    return wxyz[[1, 2, 3, 0]]
