"""The product against solvers that share no code with it, on wrenches of every kind."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.exact.stages import WORTHWHILE
from support.allocation_reference import in_allowed_set
from support.closest_reference import LESS, MORE, USUAL, ClosestOfEverySubset, Rounding, closest_subsets
from support.every_subset import EverySubset
from support.layouts import bluerov2_heavy, cube, jack

BUILT = cube(direction_noise=0.05, position_noise_m=0.01, seed=4)
PUSH_HIDDEN = 1e-5
"""Push, part of the largest, that moves a wrench by what the rounding of A hides with a change of less than a limit."""

REACTIVITY = np.array([-32.0, 44.0])


@dataclass
class Tally:
    """What a comparison has seen.

    Attributes:
        wrenches: number compared.
        exact: of them attainable.
        pinned: compared with every way of pinning thrusters to interval ends.
        solved: compared with NNLS on every subset whose half-spaces (by Qhull) hold the wrench: half of those that are
            compared with pinning, and all others.
        closest: unattainable ones compared with bounded least squares on every subset: the distance, the wrench and
            the least cost.
        several: of them those with several forces as close as any.
        as_close: of them those farther than the closest by what the rounding of A hides, for a lower cost.
        missed: of the others those with cheaper forces in half that distance, which the search may miss.
        borderline: of a reference that differs, those between the optima of slightly wider and narrower intervals.
        borderline_closest: the same among the least costs of closest wrenches.
        unconfirmed: answers ProxQP did not confirm within its own accuracy.
        largest_gap_N: largest difference of the forces among those [N].
        disagreements: what differed.
    """

    wrenches: int = 0
    exact: int = 0
    pinned: int = 0
    solved: int = 0
    closest: int = 0
    several: int = 0
    as_close: int = 0
    missed: int = 0
    borderline: int = 0
    borderline_closest: int = 0
    unconfirmed: int = 0
    largest_gap_N: float = 0.0  # noqa: N815 - N is the newton
    disagreements: list[str] = field(default_factory=list)


def wrenches_of_every_kind(A, limits, allow_off, count, seed):
    """(about count, n): tiny to far out of reach, single-axis, zero, borders, thin cells, no thrust at all."""
    rng = np.random.default_rng(seed)
    n, m = A.shape
    reach = np.abs(A) @ np.abs(limits).max(axis=1)
    part = max(count // 10, 1)
    ends = np.column_stack([limits, np.zeros(m)]) if allow_off else limits
    at_ends = ends[np.arange(m), rng.integers(0, ends.shape[1], size=(part, m))]
    one_free = ends[np.arange(m), rng.integers(0, ends.shape[1], size=(part, m))]
    which = rng.integers(0, m, size=part)
    one_free[np.arange(part), which] = limits[which, 2] + rng.random(part) * (limits[which, 3] - limits[which, 2])
    thin = at_ends * (1.0 + 1e-7 * rng.normal(size=(part, m)))
    axes = np.eye(n)[rng.integers(0, n, size=part)] * rng.choice([-1, 1], size=(part, 1)) * reach
    return np.vstack(
        [
            np.zeros((1, n)),
            *[scale * reach * rng.normal(size=(part, n)) for scale in (1e-6, 0.01, 0.05, 0.15, 2.0)],
            axes * 10.0 ** rng.uniform(-5, 0.5, size=(part, 1)),
            (rng.uniform(-1, 1, size=(part, m)) * np.abs(limits).max(axis=1)) @ A.T,
            at_ends @ A.T,
            one_free @ A.T,
            thin @ A.T,
        ]
    )


def cheapest_pinned(A, limits, allow_off, wrenches, target, weights, tolerance):
    """(N,) least ``sum w (f - t)^2`` per wrench, inf where there is none, by pinning thrusters to ends of intervals.

    The optimum of a convex cell pins some thrusters and leaves the rest to equations; forces are then linear in the
    wrench, so every choice of up to dim ker A pinned thrusters is one matrix product over all wrenches.
    """
    m = A.shape[1]
    root = np.sqrt(weights)
    scaled = A / root
    _, sigma, Vt = np.linalg.svd(scaled)
    rank = int(np.sum(sigma > 1e-9 * sigma[0]))
    N = Vt[rank:].T
    pinv = np.linalg.pinv(scaled, rcond=1e-9)
    g0 = wrenches @ pinv.T
    reachable = np.linalg.norm(g0 @ scaled.T - wrenches, axis=1) <= 1e-6
    g0 = g0 + (root * target - g0) @ N @ N.T
    best = np.full(len(wrenches), np.inf)
    for pins in range(m - rank + 1):
        for thrusters in map(list, itertools.combinations(range(m), pins)):
            rows = N[thrusters]
            if pins and np.linalg.svd(rows, compute_uv=False)[-1] < 1e-9:
                continue
            inverse = np.linalg.pinv(rows) if pins else np.zeros((N.shape[1], 0))
            ends = [sorted({*limits[i], 0.0} if allow_off else set(limits[i])) for i in thrusters]
            for values in itertools.product(*ends):
                moved = (np.array(values) * root[thrusters] - g0[:, thrusters]) @ inverse.T
                away = np.einsum("ij,ij->i", moved, moved)
                near = np.flatnonzero(away <= best)
                f = (g0[near] + moved[near] @ N.T) / root
                f[:, thrusters] = values
                allowed = in_allowed_set(f, limits, allow_off, tolerance).all(axis=1) & reachable[near]
                near, f = near[allowed], f[allowed]
                best[near] = np.minimum(best[near], ((f - target) ** 2 * weights).sum(axis=1))
    return best


def same(cost, other):
    """Whether two costs are equal but for rounding; none at all is infinite."""
    return cost == other or abs(cost - other) <= 1e-5 * (1.0 + abs(other))


def between(cost, loose, tight):
    """Whether a cost lies between two others but for rounding."""
    return (cost >= loose or same(cost, loose)) and (cost <= tight or same(cost, tight))


def compare_closest(reference, wrench, answer, targets, price, tally, where):
    """Count an unattainable wrench, and where its distance, the closest wrench or the least cost of that is another."""
    found = reference.find(wrench)
    made, least = reference.M @ answer.force, found.distance.min()
    distance = np.linalg.norm(made - reference.inside @ wrench)
    tally.closest += 1

    def cost(rounding):
        return min(reference.cheapest(found, target, price, rounding)[0] for target in targets)

    if 1e-6 + 1e-9 * least < distance - least <= reference.farthest:
        wide = Rounding(2.001 * reference.hidden_N, reference.farthest / (1.0 + least), PUSH_HIDDEN)
        tally.as_close += 1
        if not cost(wide) * (1.0 - 1e-5) <= answer.cost <= (1.0 - WORTHWHILE) * cost(LESS) + 1e-6:
            tally.disagreements.append(f"{where}: farther by {distance - least!r} at {answer.cost!r}")
        return
    if abs(distance - least) > 1e-6 + 1e-9 * least:
        tally.disagreements.append(f"{where}: distance {distance!r} against {least!r}")
    tied = cost(Rounding(LESS.force, 0.5 * reference.tie / (1.0 + least), LESS.push))
    tally.missed += answer.cost > tied / (1.0 - WORTHWHILE) + 1e-6
    wrenches = found.force[closest_subsets(found, MORE.equal)] @ reference.M.T
    if np.abs(wrenches - made).max(axis=1).min() > 1e-3:
        tally.disagreements.append(f"{where}: not the closest wrench")
    costs, several = zip(*[reference.cheapest(found, target, price, USUAL) for target in targets], strict=True)
    tally.several += any(several)
    if same(answer.cost, min(costs)):
        return
    if between(answer.cost, cost(MORE), cost(LESS)):
        tally.borderline_closest += 1
    else:
        tally.disagreements.append(f"{where}: closest at {answer.cost!r} against {min(costs)!r}")


def compare(
    A,
    limits,
    *,
    allow_off,
    objective,
    count,
    seed,
    weights=None,
    wrench_weights=None,
    penalty=0.0,
    switching=0.0,
    solver_share=1.0,
    method,
):
    """Allocate wrenches of every kind, and count where the references find another optimum."""
    m = A.shape[1]
    rng = np.random.default_rng(seed)
    limits = np.tile(limits, (m, 1)) if np.ndim(limits) == 1 else limits
    weights = np.ones(m) if weights is None else weights
    options = {
        "energy": {},
        "target": {"target": rng.uniform(-30, 40, m)},
        "reactivity": {"reactivity": REACTIVITY},
        "reactivity_by_side": {"reactivity": REACTIVITY},
    }[objective]
    allocator = Allocator(
        A, limits, allow_off=allow_off, objective=objective, weights=weights, wrench_weights=wrench_weights,
        reversal_penalty=penalty, switching_penalty=switching, method=method, **options,
    )  # fmt: skip
    tables = allocator._problem
    wrenches = wrenches_of_every_kind(A, limits, allow_off, count, seed)
    tally = Tally(wrenches=len(wrenches))
    pinned = None
    if penalty == switching == 0.0 and objective != "reactivity_by_side":
        pinned = np.min(
            [cheapest_pinned(A, limits, allow_off, wrenches, t[:, 0], weights, 1e-7) for t in tables.targets], axis=0
        )
        tally.pinned = len(wrenches)
    every = EverySubset(A, limits, allow_off, weights)
    closest = ClosestOfEverySubset(every, allocator.wrench_weights)
    for i, wrench in enumerate(wrenches):
        price = np.zeros((m, 3))
        side, push = allocator._previous[:2]
        price[push == 1, 0], price[push == -1, 2] = penalty, penalty
        price[side == 0, 0::2] += switching
        price[side != 0, 1] += switching
        answer = allocator.allocate(wrench)
        if allocator.effort.disagreements > tally.unconfirmed:
            tally.unconfirmed += 1
            gap = np.max(np.abs(allocator._confirmer._solver._qp.results.x - answer.force))
            tally.largest_gap_N = max(tally.largest_gap_N, gap)
            if gap > 1e-3:  # not a matter of ProxQP's accuracy: another force of the same subset is the optimum
                tally.disagreements.append(f"seed {seed} wrench {i}: ProxQP differs by {gap} N")
        exact = answer.status == Status.EXACT
        tally.exact += exact
        where = f"seed {seed} wrench {i}"
        if not in_allowed_set(answer.force, limits, allow_off).all() or not np.isfinite(answer.cost):
            tally.disagreements.append(f"{where}: not allowed")
        expected = []
        if pinned is not None:
            expected.append(("pinned", pinned[i]))
        if pinned is None or rng.random() < solver_share:
            solved = min(every.cheapest(wrench, target, price, 1e-7) for target in tables.targets)
            expected.append(("solver", solved))
            tally.solved += 1
        found = answer.cost if exact else np.inf
        for name, cost in expected:
            if same(found, cost):
                continue
            # On the very border of a subset it depends on what counts as rounding: the answer must then lie between
            # the optimum of intervals a little wider and that of intervals a little narrower.
            loose, tight = (
                min(every.cheapest(wrench, target, price, tolerance) for target in tables.targets)
                for tolerance in (2e-6, -2e-6)
            )
            if between(found, loose, tight):
                tally.borderline += 1
            else:
                tally.disagreements.append(f"{where} {name}: {answer.status.name} {answer.cost!r} against {cost!r}")
        if exact and answer.residual > 1e-6:
            tally.disagreements.append(f"{where}: residual {answer.residual}")
        if not exact:
            compare_closest(closest, wrench, answer, tables.targets, price, tally, where)
    if allocator.effort.unproven:
        tally.disagreements.append(f"seed {seed}: {allocator.effort}")
    return tally


def campaign(count, solver_share=1.0, method="search+proxqp"):
    """Tallies over four vehicles, ideal, as built, in the plane, and with thrusters in two planes; 0 to 4 losses, both
    sets, all objectives, weights and penalties.
    """
    limits = np.array([-40.0, -3.2, 4.0, 50.0])
    seed = 0
    vehicles = ("ideal", cube(), 4), ("as built", BUILT, 4), ("planar", jack(), 1), ("two planes", bluerov2_heavy(), 2)
    for name, vehicle, most_lost in vehicles:
        for lost in range(most_lost + 1):
            rng = np.random.default_rng(lost)
            A = np.delete(vehicle, rng.choice(vehicle.shape[1], lost, replace=False), axis=1)
            for allow_off in (True, False):
                for objective in ("energy", "target", "reactivity", "reactivity_by_side"):
                    seed += 1
                    extra = {}
                    if seed % 3 == 0:
                        extra["weights"] = rng.uniform(0.3, 3.0, A.shape[1])
                    if seed % 5 == 0:
                        extra["penalty"] = 200.0
                    if seed % 7 == 0:
                        extra["switching"] = 150.0
                    if seed % 4 == 0:
                        extra["solver_share"] = solver_share
                    if seed % 11 == 0:
                        extra["wrench_weights"] = np.ones(len(A))
                    label = f"{name}, {lost} lost, {'off' if allow_off else 'strict'}, {objective}, {sorted(extra)}"
                    zone = limits * ([1, 1, 1, 1] if seed % 2 else [1, 2.5, 2.5, 1])
                    extra.setdefault("solver_share", solver_share)
                    yield (
                        label,
                        compare(
                            A,
                            zone,
                            allow_off=allow_off,
                            objective=objective,
                            count=count,
                            seed=seed,
                            method=method,
                            **extra,
                        ),
                    )
