"""Allocation methods side by side on the same wrenches, interleaved so that a busy machine disturbs all alike.

    python benchmarks/allocation.py [--wrenches 2000] [--enumerated 20] [--dead-zone 0.1] [--strict]

Prints median, 99th percentile and worst time per wrench, ProxQP problems per wrench, and disagreements in cost with
the exact search.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from cube_sim.allocation import Allocator, Status


def built_cube(seed: int) -> np.ndarray:
    """(6, 8) the cube with 5 % direction and 1 cm position errors, as a workshop would build it."""
    p, q, c = 0.5 + 1 / np.sqrt(12), 0.5 - 1 / np.sqrt(12), 1 / np.sqrt(3)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    r, u = [], []
    for z in (1.0, -1.0):
        corner, axis = 0.2 * np.array([1.0, 1.0, z]), np.array([q, -p, z * c])
        for _ in range(4):
            r.append(corner)
            u.append(axis)
            corner, axis = quarter @ corner, quarter @ axis
    rng = np.random.default_rng(seed)
    r = np.array(r) + 0.01 * rng.normal(size=(8, 3))
    u = np.array(u) + 0.05 * rng.normal(size=(8, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    return np.vstack([u.T, np.cross(r, u).T])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wrenches", type=int, default=2000)
    parser.add_argument("--enumerated", type=int, default=20, help="wrenches the slow reference also solves")
    parser.add_argument("--dead-zone", type=float, default=0.1, help="part of the maximum force")
    parser.add_argument("--strict", action="store_true", help="motors may not rest: the report's 2^m subsets")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()

    A = built_cube(options.seed)
    limits = np.array([-40.0, -40.0 * options.dead_zone, 50.0 * options.dead_zone, 50.0])
    methods = {
        name: Allocator(A, limits, allow_off=not options.strict, method=name)
        for name in ("search", "search+proxqp", "enumerate")
    }
    spread = np.array([20.0, 20.0, 20.0, 5.0, 5.0, 5.0])
    wrenches = np.random.default_rng(options.seed).normal(size=(options.wrenches, 6)) * spread
    for name in ("search", "search+proxqp"):  # compile, and touch every path once
        methods[name].allocate(wrenches[0])
        methods[name].allocate(100.0 * wrenches[0])
        methods[name].effort.qps = 0

    seconds = {name: [] for name in methods}
    wrong = dict.fromkeys(methods, 0)
    for i, wrench in enumerate(wrenches):
        costs = {}
        for name, allocator in methods.items():
            if name == "enumerate" and i >= options.enumerated:
                continue
            start = time.perf_counter()
            answer = allocator.allocate(wrench)
            seconds[name].append(time.perf_counter() - start)
            costs[name] = answer.cost if answer.status == Status.EXACT else np.inf
        for name, cost in costs.items():
            wrong[name] += not np.isclose(cost, costs["search"], rtol=1e-5, atol=1e-6)

    base = np.median(seconds["enumerate"]) if seconds["enumerate"] else np.nan
    print(f"{'method':<16}{'median us':>12}{'p99 us':>12}{'max us':>12}{'QPs':>8}{'faster':>9}{'disagree':>14}")
    for name, times in seconds.items():
        if times:
            median, p99 = np.percentile(times, [50, 99])
            print(
                f"{name:<16}{median * 1e6:>12.0f}{p99 * 1e6:>12.0f}{max(times) * 1e6:>12.0f}"
                f"{methods[name].effort.qps / len(times):>8.1f}{base / median:>8.0f}x{wrong[name]:>8d}/{len(times)}"
            )


if __name__ == "__main__":
    main()
