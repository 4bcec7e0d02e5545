"""Where what an agent sees stands in one flat vector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, pi
from typing import NamedTuple

import numpy as np

from cube_sim.flight import Observation
from cube_sim.guidance.path import Path
from cube_sim.gym.actions import ActionScale
from cube_sim.mission.own.law import rotation_between
from cube_sim.spatial import Vector

FAR_M, FAST = 1000.0, 100.0
"""Bounds of distances [m], and of speeds and turns [m/s, rad/s]: what lies beyond is seen as them."""


class LayoutPart(NamedTuple):
    """A part of the vector.

    Attributes:
        name: of it.
        size: how many numbers.
        unit: of each.
        bound: their largest size.
        meaning: in words.
    """

    name: str
    size: int
    unit: str
    bound: float
    meaning: str


@dataclass(frozen=True)
class ObservationLayout:
    """The parts in their order, and the vector of an observation.

    Attributes:
        parts: the parts.
        ahead_m: (k,) how far from the target the points ahead are, along the path [m].
        wrench: scale of the last wrench.
        forces: scale of the thrusters' forces.
    """

    parts: tuple[LayoutPart, ...]
    ahead_m: tuple[float, ...]
    wrench: ActionScale
    forces: ActionScale

    @staticmethod
    def of(wrench: ActionScale, forces: ActionScale, ahead_m: Sequence[float]) -> ObservationLayout:
        """The layout for a vehicle and distances ahead."""
        k, m = len(ahead_m), len(forces.low)
        parts = (
            LayoutPart("error", 3, "m", FAR_M, "(s1, y1, z1) of the vehicle in the path's frame at its target"),
            LayoutPart("attitude", 3, "rad", pi, "rotation vector to the attitude the controller wants, body axes"),
            LayoutPart("velocity", 3, "m/s", FAST, "over ground, body axes"),
            LayoutPart("rates", 3, "rad/s", FAST, "angular velocity, body axes"),
            LayoutPart("up", 3, "1", 1.0, "the world's vertical, body axes"),
            LayoutPart("target_speed", 1, "m/s", FAST, "of the target along the path"),
            LayoutPart("remaining", 1, "m", FAR_M, "arc length from the target to where its run ends"),
            LayoutPart("ways", 3 * k, "m", FAR_M, "from the vehicle to the path at each distance ahead, body axes"),
            LayoutPart("tangents", 3 * k, "1", 1.0, "of the path there, body axes"),
            LayoutPart("wrench", 6, "1", 1.0, "commanded over the tick before, as a share of the largest"),
            LayoutPart("forces", m, "1", 1.0, "of the thrusters now, as a share of the largest"),
        )
        return ObservationLayout(parts, tuple(float(d) for d in ahead_m), wrench, forces)

    @cached_property
    def bounds(self) -> Vector:
        """(n,) largest size of each number."""
        return np.concatenate([np.full(part.size, part.bound) for part in self.parts])

    def at(self, name: str) -> slice:
        """Where a part stands in the vector.

        Raises:
            KeyError: there is none of that name.
        """
        start = 0
        for part in self.parts:
            if part.name == name:
                return slice(start, start + part.size)
            start += part.size
        raise KeyError(f"no part '{name}'; there are {', '.join(part.name for part in self.parts)}")

    def vector(self, seen: Observation, path: Path) -> Vector:
        """(n,) of an observation. The vehicle is where its controller believes it: at the estimate, if there is one."""
        state, view = seen.estimate, seen.view
        R, point = state.rotation, view.point
        ahead = [path.at(view.arc_length + d) for d in self.ahead_m]
        values = (
            (state.position - point.position) @ point.rotation,
            rotation_between(np.asarray(state.quaternion), seen.wanted),
            state.velocity,
            state.rates,
            R[2],
            [view.speed],
            [view.remaining if view.remaining < inf else FAR_M],
            *[(there.position - state.position) @ R for there in ahead],
            *[there.rotation[:, 0] @ R for there in ahead],
            self.wrench.share(seen.wrench),
            self.forces.share(seen.force),
        )
        bounds = self.bounds
        return np.clip(np.concatenate(values), -bounds, bounds)
