"""One allocation over the thrusters that respond, compiled: what `FaultTolerant` does with the exact search."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.asked_forces import asked_forces
from cube_sim.allocation.exact.code import SEARCHING
from cube_sim.allocation.exact.fewest_calls import INSTEAD
from cube_sim.allocation.exact.side_limits import put_limits
from cube_sim.native.callee import call_at
from cube_sim.native.compiled import compiled


@compiled
def widen_dead_zones(limits, margin, wider):
    """Limits (m,4) whose dead zones are wider by a share, never beyond saturation, into `wider` (m,4) [N]."""
    for i in range(len(limits)):
        wider[i, 0], wider[i, 3] = limits[i, 0], limits[i, 3]
        wider[i, 1] = max(limits[i, 0], limits[i, 1] * (1.0 + margin))
        wider[i, 2] = min(limits[i, 3], limits[i, 2] * (1.0 + margin))


@compiled
def limits_of_some(limits, which, efficiency):
    """(k,4) [N] the limits of those thrusters, by what they give; of all (m,4) whole ones and their shares (m,)."""
    some = np.empty((len(which), 4))
    for j in range(len(which)):
        for side in range(4):
            some[j, side] = efficiency[which[j]] * limits[which[j], side]
    return some


class ResponsiveThrusters(NamedTuple):
    """What is allocated over, and what the answer before was.

    Attributes:
        packed: of the search for the k thrusters that respond; the previous answer in it is moved on.
        which: (k,) those thrusters, from 0.
        held: (m,) forces of stuck thrusters [N], 0 of all others.
        held_wrench: (n,) of these.
        efficiency: (m,) share of its force that each gives.
        responds: (m,) bool.
        limits: (m,4) of whole thrusters [N].
        rounding: force that is one [N].
        force: (m,) of the answer before [N]; moved on, like the next two.
        subset: (m,) the side each thruster is on.
        push: (m,) direction each thruster last pushed to.
    """

    packed: NDArray[np.float64]
    which: NDArray[np.int_]
    held: NDArray[np.float64]
    held_wrench: NDArray[np.float64]
    efficiency: NDArray[np.float64]
    responds: NDArray[np.bool_]
    limits: NDArray[np.float64]
    rounding: float
    force: NDArray[np.float64]
    subset: NDArray[np.float64]
    push: NDArray[np.float64]


@compiled
def limit_thrusters(thrusters, limits, margin):
    """Allocate from now on within limits of the moment.

    Args:
        thrusters: `ResponsiveThrusters`, whose search it is.
        limits: (m,4) of whole thrusters [N].
        margin: share by which their dead zones are taken to be wider.
    """
    t = thrusters
    widen_dead_zones(limits, margin, t.limits)
    put_limits(t.packed, limits_of_some(t.limits, t.which, t.efficiency))


@compiled
def allocate_responsive(codes, thrusters, demand, secondary, force_ratio, parts, demands, row, sides, wrench, effort):
    """Forces of all thrusters for a demand, into `thrusters.force`; see `FaultTolerant.allocate` and `allocate_at`.

    Args:
        codes: `cube_sim.allocation.flown.SearchCodes`.
        thrusters: `ResponsiveThrusters`.
        demand: (n,) all that is demanded [N, N m], finite.
        secondary: (n,) the part of it that gives way; zero for none.
        force_ratio: share of its force that the supply leaves each thruster, above 0.
        parts: (2 n,) scratch.
        demands: (n,) out: what the search was asked for.
        row: of `answer_of`, out.
        sides: (k,) scratch.
        wrench: (n,) out: what is made.
        effort: (2,) nodes looked at and answers not proven, counted on.

    Returns:
        The forces (m,) to ask of the thrusters as if they were whole and fully fed [N]; residual [N], cost [N^2],
        status.
    """
    t, n, scaled = thrusters, len(demand), force_ratio != 1.0
    yields = False
    for a in range(n):
        whole, part = demand[a], secondary[a]
        if scaled:
            whole, part = whole / force_ratio, part / force_ratio
        yields = yields or part != 0.0
        left = whole - t.held_wrench[a]
        parts[a], parts[n + a], demands[a] = left - part, part, left
    if yields:
        for a in range(n):
            demands[a] = parts[a] + parts[n + a]
    told = parts if yields else demands
    if codes.instead != 0:
        call_at(INSTEAD, codes.instead, (codes.search, codes.travel, t.packed, told, row, sides, effort))
    else:
        _, _, _, nodes, doubts = call_at(SEARCHING, codes.search, (t.packed, told, row, sides))
        effort[0] += nodes
        effort[1] += doubts
    residual, cost, status = row[-4], row[-3], int(row[-2])
    k, m = len(t.which), len(t.held)
    for i in range(m):
        t.force[i], t.subset[i] = t.held[i], np.sign(t.held[i])
    for j in range(k):
        i = t.which[j]
        t.force[i], t.subset[i] = row[j], sides[j]
    for a in range(n):
        wrench[a] = row[k + a] if k == m else row[k + a] + t.held_wrench[a]
    for i in range(m):
        if t.subset[i] != 0.0:
            t.push[i] = t.subset[i]
    asked = asked_forces(t.force, t.efficiency, t.responds, t.limits, t.rounding)
    if scaled:
        residual, cost = residual * force_ratio, cost * (force_ratio * force_ratio)
        for a in range(n):
            wrench[a] *= force_ratio
    return asked, residual, cost, status
