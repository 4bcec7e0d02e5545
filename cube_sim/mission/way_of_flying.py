"""How a vehicle flies, told at the beginning of a run: what its thrusters do, and what is left to the water."""

from __future__ import annotations

import numpy as np

from cube_sim.control.authority import Authority, Capability
from cube_sim.control.judged_capability import remaining_capability
from cube_sim.mission.ability import Ability
from cube_sim.spatial import Matrix
from cube_sim.wrench.health import Health

CLIMBS_M = 0.1
"""A path that rises or sinks by less counts as level (a choice)."""
HEAVY = 0.001
"""A hull whose weight and buoyancy differ by less than this share of its weight floats (a choice)."""

STEERED_AT_SPEED_ONLY = "it steers by fins, which make nothing without way on: it cannot hold a point"
"""Said of a vehicle whose thrusters alone follow no path."""

_WAYS = {
    Authority.HOLONOMIC: "moves any way in any attitude",
    Authority.PLANE: "turns its attitude to point thrust that is there in two directions",
    Authority.LINE: "turns its attitude to point thrust that is there in one direction",
    Authority.SAFE: "cannot follow a path",
    Authority.LEVEL: "moves any way in a level plane; heave, roll and pitch are left to the water",
    Authority.UNICYCLE: "turns its heading to point its thrust in a level plane; heave, roll and pitch are left to the "
    "water",
    Authority.TRIM: "moves any way, and roll or pitch are left to the water",
    Authority.TURNED: "moves any way while what is stuck turns it round",
}


def way_of_flying(able: Ability) -> str:
    """What the thrusters do, in a sentence."""
    left = able.within_limit
    told = f"{left.authority.name}: the vehicle {_WAYS[left.authority]} ({left.reason})"
    if left.within_cost_limit is None:
        return told
    dear = "costs too much" if able.cost_limit is None else f"costs more than {able.cost_limit:g} N/N"
    return f"{told}; what {dear} is left alone"


def cannot_follow(able: Ability, points: Matrix) -> str | None:
    """Why the vehicle will not follow the path, as far as that can be told beforehand; None where it may.

    Args:
        able: what the thrusters can do.
        points: (n,3) on the path [m], world axes.
    """
    left = able.within_limit
    if left.authority is Authority.SAFE:
        return f"the path will not be followed: {left.reason}"
    return depth_not_kept(able, left, points) or able.badly_pointed(left) or able.too_tight(left)


def steered_at_speed_only(able: Ability) -> str | None:
    """Words for a vehicle that cannot stay in a place, since its fins do nothing at rest; None for all others.

    Args:
        able: what the thrusters and fins can do.
    """
    if able.fins is None:
        return None
    hold = able.hold._replace(inclinations=None)
    alone = remaining_capability(able.A, able.limits, Health.whole(able.A.shape[1]), able.cost_limit, hold)
    return STEERED_AT_SPEED_ONLY if alone.authority is Authority.SAFE else None


def depth_not_kept(able: Ability, left: Capability, points: Matrix) -> str | None:
    """Why a vehicle that moves in a level plane will not keep the path's depth; None for all others, and where it may.

    Args:
        able: what the thrusters could do at the beginning.
        left: what they can do.
        points: as for `cannot_follow`.
    """
    if not left.level:
        return None
    said = []
    height = float(np.ptp(points[:, 2]))
    if height > CLIMBS_M:
        said.append(f"the path rises or sinks by {height:.2g} m")
    hull = able.hold.hull
    if hull is not None and abs(hull.weight - hull.buoyancy) > HEAVY * hull.weight:
        sinks = hull.weight > hull.buoyancy
        said.append(f"the hull {'sinks' if sinks else 'rises'} with {abs(hull.weight - hull.buoyancy):.2g} N")
    if not said:
        return None
    return f"the depth of the path will not be kept: {' and '.join(said)}, and no thruster pushes up or down"
