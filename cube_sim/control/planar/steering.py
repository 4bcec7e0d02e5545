"""All of a tick of the planar law in one compiled call, from the vehicle seen from its target to the wrench."""

from __future__ import annotations

from functools import cache
from math import atan2, cos, hypot, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.planar.approach_angle import approach_angle
from cube_sim.control.planar.attainable_set import saturate
from cube_sim.control.planar.dynamic import LAW, DesiredSpeed, dynamic_command, flow_over_ground
from cube_sim.control.planar.kinematic import kinematic_command
from cube_sim.control.planar.model import PlanarModel, PlanarMotion
from cube_sim.control.planar.observer import ObserverParts, PlanarObserver, observe_water
from cube_sim.control.planar.path_view import PathView, heading, plane_view, wrap
from cube_sim.control.planar.short_of_torque import SHARE, torque_share, watch_torque
from cube_sim.control.planar.turning_profile import TurningParts, turning_speed_at
from cube_sim.guidance.speed import ConstantSpeed
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record

Array = NDArray[np.float64]

SETTINGS = np.dtype([("waits", np.bool_), ("follows", np.bool_)])
"""Whether speed is given up while torque is short, and whether the path is followed at all."""
ESTIMATED = np.dtype([("disturbance", np.float64, 6), ("current", np.float64, 3)])
"""What the model does not explain [N, N m], body axes, and the current reckoned with [m/s], world axes."""


class PlanarParts(NamedTuple):
    """What a tick of the planar law reads and moves on beside the tick's own numbers.

    Attributes:
        settings: record `SETTINGS`.
        law: record of `cube_sim.control.planar.dynamic.LAW`.
        profile: u_d along the path.
        normals: of `PlanarAttainableSet`, like the next.
        sizes: of it.
        observer: of the water, its memory moved on.
        short: memory of `watch_torque`, moved on.
        estimated: record `ESTIMATED`, filled.
    """

    settings: Record
    law: Record
    profile: TurningParts
    normals: Array
    sizes: Array
    observer: ObserverParts
    short: Record
    estimated: Record


@compiled
def wanted_speed(planned, slope, share, current, target_speed):
    """u_d over ground, a `DesiredSpeed`: as planned, less what is given up for want of torque.

    Through the water it is no slower than the water itself: a hull that is slower than the current cannot head up
    against it when its path turns. The rate of change of the plan is fed forward, the rate of that is not.

    Args:
        planned: [m/s].
        slope: of it along the path [1/s].
        share: of it that is left.
        current: `PlanarCurrent` of the water.
        target_speed: s' [m/s], at which the plan goes by.
    """
    least = current.u + hypot(current.u, current.v)
    if share * planned < least:
        return DesiredSpeed(least, 0.0, 0.0)
    return DesiredSpeed(share * planned, share * slope * target_speed, 0.0)


@compiled
def steer(parts, view, desired, followed, R, v, w, applied, dt):
    """One tick.

    Args:
        parts: `PlanarParts`.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`, whose quaternion is filled.
        followed: record of `cube_sim.control.following.FOLLOWED`, zero at first, filled.
        R: R_WB (3,3).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        applied: wrench (6,) allocated over the tick before [N, N m].
        dt: [s].
    """
    p, s, law, hull = parts, parts.settings[0], parts.law[0], parts.observer.hull[0]
    motion, psi_B = PlanarMotion(v[0], v[1], w[2]), heading(R)
    water = observe_water(p.observer, psi_B, motion, applied[0], applied[1], applied[5], dt)
    flow = flow_over_ground(law, motion, water.current)
    path = plane_view(view, psi_B + atan2(flow.v, flow.u))
    if view[0].remaining <= 0.0:
        path = PathView(path.s1, path.y1, path.psi, 0.0, 0.0)  # the path goes on straight
    planned, slope = turning_speed_at(p.profile, view[0].arc_length)
    speed = wanted_speed(planned, slope, p.short[0].share, water.current, view[0].speed)
    command = dynamic_command(law, hull, motion, path, speed, water)
    F, Gamma = saturate(p.normals, p.sizes, command.F, command.Gamma, torque_share(motion.u, planned))
    if s.waits:
        watch_torque(p.short, motion.u, planned, command.Gamma, Gamma, dt)
    turning = kinematic_command(law, hull, flow, path, water.current, water.dv)
    error = wrap(path.psi - approach_angle(law, path.y1).value)
    out, estimated, current = followed[0], p.estimated[0], p.observer.filtered[0].current
    if s.follows:
        out.wrench[0], out.wrench[5] = F, Gamma
    out.velocity[0], out.rates[2] = speed.value, turning.r
    out.attitude_error, out.pace, out.enough = abs(error), 1.0, True
    wanted, half = desired[0].quaternion, 0.5 * (psi_B - error)
    wanted[0], wanted[1], wanted[2], wanted[3] = cos(half), 0.0, 0.0, sin(half)
    estimated.disturbance[0], estimated.disturbance[1] = hull.m_u * water.du, hull.m_v * water.dv
    estimated.disturbance[5] = hull.m_r * water.dr
    estimated.current[0], estimated.current[1] = current[0], current[1]


@cache
def resting_planar_law() -> PlanarParts:
    """Arguments of `steer` of the right types, for a flight that another law steers."""
    observer = PlanarObserver(PlanarModel(1.0, 1.0, 1.0, 1.0), np.zeros(2), None, None)
    told = np.zeros(1, SETTINGS), np.zeros(1, LAW), TurningParts.of(ConstantSpeed(1.0))
    return PlanarParts(*told, np.zeros((0, 2)), np.zeros(0), observer.parts, np.zeros(1, SHARE), np.zeros(1, ESTIMATED))
