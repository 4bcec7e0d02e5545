"""Saying that a vehicle leaves the water: when, for how long, how high."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_conditions import OUT_OF_THE_WATER
from cube_sim.vehicle.floating import water_surface
from cube_sim.vehicle.vehicle import Vehicle

CLEAR_M = 1e-3
"""What is out of the water by less is at the surface (choice) [m]."""
SUBMERGED_S = 1.0
"""A hull has dived again once it has been under water for this long: one that bobs is out of it once (choice) [s]."""

_WITHOUT_EXTENT = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)


class Boxes(NamedTuple):
    """The geoms of a hull, of `top_of`.

    Attributes:
        geoms: (g,) which ones.
        radii: (g,) of their spheres [m].
        centres: (g,3) of their boxes [m], in their own axes.
        halves: (g,3) half the sizes of their boxes [m].
        surface: height of the water's surface, world axes [m]; inf for endless water.
    """

    geoms: NDArray[np.int_]
    radii: NDArray[np.float64]
    centres: NDArray[np.float64]
    halves: NDArray[np.float64]
    surface: float


class SurfaceWatch:
    """Logs each time that the vehicle comes out of the water, and at the end how long and how high it was.

    Its top is that of its geoms, those of its moving parts included, and of its propellers where it is upright; one
    without geoms is its origin.

    Args:
        recorder: whose log it is.
        model: the compiled model.
        vehicle: the hull.

    Attributes:
        boxes: of its geoms.
    """

    def __init__(self, recorder: SignalStore, model: mujoco.MjModel, vehicle: Vehicle) -> None:
        self._recorder, self._body = recorder, vehicle.body
        self.boxes = _boxes(model, vehicle)
        self._out, self._dry_at = False, -np.inf
        self._emergences, self._highest, self._time_out, self._noted_at = 0, -np.inf, 0.0, 0.0

    def note(self, t: float, data: mujoco.MjData) -> None:
        """Take in the poses of one tick, at t [s]."""
        since, self._noted_at = t - self._noted_at, t
        origin = float(data.xpos[self._body, 2])
        top = max(origin, self._top(data))
        if top > self.boxes.surface + CLEAR_M:
            self._highest, self._dry_at = max(self._highest, top), t
            if self._out:
                self._time_out += since
            else:
                self._out = True
                self._emergences += 1
                self._recorder.log(
                    t,
                    "WARNING",
                    f"{OUT_OF_THE_WATER.begins}its top is at z = {top:.2f} m, its origin at {origin:.2f} m, the "
                    f"surface at {self.boxes.surface:.2f} m",
                )
        elif self._out and t - self._dry_at >= SUBMERGED_S:
            self._out = False
            self._recorder.log(t, "INFO", OUT_OF_THE_WATER.ends)

    @property
    def under_water(self) -> bool:
        """Whether the vehicle has been under water for long enough for that to be no news."""
        return not self._out

    def note_under_water(self, t: float) -> None:
        """Take in that the vehicle is still under water at t [s], and was at all ticks before."""
        self._noted_at = t

    def finish(self, t: float) -> None:
        """Sum up at the end of the run, at t [s]."""
        if self._emergences:
            times = "once" if self._emergences == 1 else f"{self._emergences} times"
            self._recorder.log(
                t,
                "WARNING",
                f"the hull came out of the water {times}, for {self._time_out:.2f} s in all, its top at z = "
                f"{self._highest:.2f} m at most: of waves and spray nothing is known",
            )

    def _top(self, data: mujoco.MjData) -> float:
        """Height of the highest geom's bounding box [m]; its sphere's as long as that is under water."""
        return top_of(data.geom_xpos, data.geom_xmat, *self.boxes)


@compiled
def top_of(places, rotations, geoms, radii, centres, halves, surface):
    """Height of the highest bounding box of geoms [m]; of the highest bounding sphere while that is under water.

    Args:
        places: MuJoCo's geom_xpos.
        rotations: MuJoCo's geom_xmat.
        geoms: (n,) which ones.
        radii: (n,) of their spheres [m].
        centres: (n,3) of their boxes [m], in their own axes.
        halves: (n,3) half the sizes of their boxes [m].
        surface: height of the water's surface [m].
    """
    spheres = boxes = -np.inf
    for i in range(len(geoms)):
        geom = geoms[i]
        height = places[geom, 2]
        spheres = max(spheres, height + radii[i])
        for j in range(3):  # third row of R_WG
            height += rotations[geom, 6 + j] * centres[i, j] + abs(rotations[geom, 6 + j]) * halves[i, j]
        boxes = max(boxes, height)
    return spheres if spheres <= surface else boxes


def top_over_origin(model: mujoco.MjModel, vehicle: Vehicle) -> float:
    """Height of an upright hull's highest point, a propeller's or its own, over its origin [m]; 0 without geoms."""
    data = _upright(model, vehicle)
    return max(0.0, top_of(data.geom_xpos, data.geom_xmat, *_boxes(model, vehicle)[:-1], -np.inf))


def _boxes(model: mujoco.MjModel, vehicle: Vehicle) -> Boxes:
    its_own = model.body_rootid[model.geom_bodyid] == model.body_rootid[vehicle.body]
    geoms = np.flatnonzero(its_own & ~np.isin(model.geom_type, _WITHOUT_EXTENT))
    boxes = model.geom_aabb[geoms]
    found = Boxes(
        geoms, model.geom_rbound[geoms].copy(), boxes[:, :3].copy(), boxes[:, 3:].copy(), water_surface(model)
    )
    return _up_to_its_thrusters(model, vehicle, found) if len(geoms) else found


def _up_to_its_thrusters(model: mujoco.MjModel, vehicle: Vehicle, boxes: Boxes) -> Boxes:
    """The same, the box of the upright hull's top up to its highest propeller, which else would be out before it is."""
    data = _upright(model, vehicle)
    sites = model.actuator_trnid[vehicle.thrusters.actuators, 0]
    propellers = (data.site_xpos[sites, 2] + model.site_size[sites, 0]).max(initial=-np.inf)
    up = data.geom_xmat[boxes.geoms, 6:]  # third row of R_WG
    tops = data.geom_xpos[boxes.geoms, 2] + (up * boxes.centres + np.abs(up) * boxes.halves).sum(axis=1)
    k = int(np.argmax(tops))
    if propellers > tops[k]:
        j = int(np.argmax(np.abs(up[k])))
        more = float(propellers - tops[k]) / abs(float(up[k, j]))
        boxes.radii[k] += more
        boxes.halves[k, j] += 0.5 * more
        boxes.centres[k, j] += 0.5 * more * np.sign(up[k, j])
    return boxes


def _upright(model: mujoco.MjModel, vehicle: Vehicle) -> mujoco.MjData:
    """With the hull's origin in that of the world."""
    data = mujoco.MjData(model)
    data.qpos[vehicle.qpos_address : vehicle.qpos_address + 7] = 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    mujoco.mj_kinematics(model, data)
    return data


def path_above_surface(points: NDArray[np.float64], surface: float, top: float) -> str | None:
    """The warning that a path takes its hull out of the water, or part of it; None for one that does not.

    Args:
        points: (n,3) on the path [m], world axes.
        surface: height of the water's surface [m], world axes.
        top: of the upright hull over its origin [m].
    """
    highest = float(points[:, 2].max())
    if highest + top <= surface + CLEAR_M:
        return None
    if highest <= surface + CLEAR_M:
        return (
            f"the path comes within {max(0.0, surface - highest):.2f} m of the surface, and the hull's top is "
            f"{top:.2f} m above its origin: what is out of the water displaces none, and its thrusters push nothing"
        )
    return (
        f"the path comes out of the water, it rises to z = {highest:.2f} m, the surface is at {surface:.2f} m: a hull "
        "that leaves the water loses what carries it, and its thrusters what they push against"
    )
