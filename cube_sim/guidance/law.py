"""What path following, trajectory tracking and point stabilisation have in common.

A target says where on the path the vehicle should be, a motion law which velocity brings it there. In path following
the target waits for the vehicle (`VirtualTarget` with `Approach`); in trajectory tracking it does not, it runs by the
clock (`ClockedTarget` with `Pursuit`); in point stabilisation it has nowhere to go (the same on a `Point`).
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from cube_sim.guidance.path import PathPoint
from cube_sim.spatial import Vector


class TargetView(NamedTuple):
    """The vehicle as seen from the target.

    Attributes:
        arc_length: s of the target [m]; on a closed path it counts on over the laps.
        remaining: arc length from the target to where its run ends [m]; infinite on endless laps.
        speed: s' of the target [m/s].
        point: the path at s.
        error: (s1, y1, z1) = R_F' (p - p_d(s)) [m].
        velocity: (v_T, v_1, v_2), the vehicle's velocity in the path frame [m/s].
    """

    arc_length: float
    remaining: float
    speed: float
    point: PathPoint
    error: Vector
    velocity: Vector


class DesiredMotion(NamedTuple):
    """What the velocity loop is to follow, world axes.

    Attributes:
        velocity: over ground (3,) [m/s].
        acceleration: its time derivative along the present motion (3,) [m/s^2].
    """

    velocity: Vector
    acceleration: Vector


class Target(Protocol):
    """A point that runs along a path."""

    arc_length: float

    def view(self, position: Vector, velocity_W: Vector) -> TargetView:
        """The vehicle in the target's frame, and the target's speed.

        Args:
            position: p_WB (3,) [m].
            velocity_W: velocity over ground (3,) [m/s], world axes.
        """
        ...

    def advance(self, speed: float, dt: float) -> None:
        """Move on for dt [s], starting at s' = speed [m/s]."""
        ...


class MotionLaw(Protocol):
    """A rule that gives the desired velocity of a vehicle seen from its target."""

    def motion(self, view: TargetView) -> DesiredMotion:
        """Desired velocity and its derivative along the present motion."""
        ...
