"""Allocation methods side by side on the same wrenches, interleaved so that a busy machine disturbs all alike.

    python benchmarks/allocation.py [--wrenches 2000] [--rounds 3] [--enumerated 20] [--dead-zone 0.1] [--off]

The report's algorithm (one ProxQP for each of the 2^m subsets, serial and over all cores) against the exact search
alone, the search confirmed by one ProxQP, and the search in a batch; then a map of 512 x 512 wrenches. Prints median,
99th percentile and worst time of all calls, ProxQP problems per call, and disagreements in cost with the search.
Every wrench is allocated in several rounds; "quiet p99" is the 99th percentile over the
wrenches of their quickest round: what the slowest wrenches cost, without what the machine did meanwhile.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from cube_sim.allocation import Allocator, Status
from cube_sim.allocation.attainable_map import attainable_map


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


def exact_cost(answer) -> float:
    return answer.cost if answer.status == Status.EXACT else np.inf


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wrenches", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=3, help="times every wrench is allocated by the quick methods")
    parser.add_argument("--enumerated", type=int, default=20, help="wrenches the slow references also solve")
    parser.add_argument("--dead-zone", type=float, default=0.1, help="part of the maximum force")
    parser.add_argument(
        "--off", action="store_true", help="thrusters may rest: 3^m subsets in place of the report's 2^m"
    )
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if min(options.wrenches, options.rounds) < 1:
        parser.error("--wrenches and --rounds must be 1 at least")
    if not 0.0 <= options.dead_zone <= 1.0:
        parser.error(f"--dead-zone {options.dead_zone:g}: must lie in 0 to 1, it is a part of the maximum force")

    A = built_cube(options.seed)
    limits = np.array([-40.0, -40.0 * options.dead_zone, 50.0 * options.dead_zone, 50.0])
    names = ("enumerate", "enumerate_parallel", "search+proxqp", "search")
    methods = {name: Allocator(A, limits, allow_off=options.off, method=name) for name in names}
    spread = np.array([20.0, 20.0, 20.0, 5.0, 5.0, 5.0])
    wrenches = np.random.default_rng(options.seed).normal(size=(options.wrenches, 6)) * spread
    for name in ("search", "search+proxqp"):  # compile, and touch every path once
        methods[name].allocate(wrenches[0])
        methods[name].allocate(100.0 * wrenches[0])
        methods[name].effort.qps = 0

    wall = {name: [] for name in (*names, "batch")}
    quiet = {name: {} for name in (*names, "batch")}
    wrong = dict.fromkeys((*names, "batch"), 0)
    batch, block = Allocator(A, limits, allow_off=options.off, method="search"), 100
    batch.allocate_many(wrenches[:1])

    def timed(name: str, i: int, call, argument, count: int = 1):
        start = time.perf_counter()
        answer = call(argument)
        took = (time.perf_counter() - start) / count
        wall[name].append(took)
        quiet[name][i] = min(quiet[name].get(i, np.inf), took)
        return answer

    for turn in range(options.rounds):
        for allocator in (*methods.values(), batch):
            allocator.reset()
        for i, wrench in enumerate(wrenches):
            costs = {}
            for name, allocator in methods.items():
                if name.startswith("enumerate") and (turn > 0 or i >= options.enumerated):
                    continue
                costs[name] = exact_cost(timed(name, i, allocator.allocate, wrench))
            for name, cost in costs.items():
                wrong[name] += not np.isclose(cost, costs["search"], rtol=1e-5, atol=1e-6)
            spinning = turn == 0 and i < options.enumerated  # threads of the enumeration, for a while
            if i % block == 0 and not spinning:
                part = wrenches[i : i + block]
                answers = timed("batch", i, batch.allocate_many, part, len(part))
                there = np.where(answers.status == Status.EXACT, answers.cost, np.inf)
                alone = [exact_cost(methods["search"].allocate(w)) for w in part]
                wrong["batch"] += int(np.sum(~np.isclose(there, alone, rtol=1e-5, atol=1e-6)))

    base = np.median(wall["enumerate"]) if wall["enumerate"] else np.nan
    print(f"{options.wrenches} wrenches, {'3^8 subsets' if options.off else '2^8 subsets'}, times in us")
    print(f"{'method':<20}{'median':>11}{'p99':>11}{'max':>11}{'quiet p99':>11}{'QPs':>8}{'faster':>9}{'disagree':>10}")
    for name, times in wall.items():
        if times:
            median, p99 = np.percentile(times, [50, 99]) * 1e6
            slowest = np.percentile(list(quiet[name].values()), 99)
            qps = methods[name].effort.qps / len(times) if name in methods else 0.0
            print(
                f"{name:<20}{median:>11.1f}{p99:>11.1f}{max(times) * 1e6:>11.1f}"
                f"{slowest * 1e6:>11.1f}{qps:>8.1f}{base / (median * 1e-6):>8.0f}x"
                f"{wrong[name]:>10d}"
            )

    across, down = np.array([150.0, 0, 0, 0, 0, 0]), np.array([0, 0, 0, 0, 0, 40.0])
    attainable_map(A, limits, np.zeros(6), across, down, (2, 2), allow_off=options.off)
    start = time.perf_counter()
    found = attainable_map(A, limits, np.zeros(6), across, down, allow_off=options.off)
    print(f"map of 512 x 512 wrenches: {time.perf_counter() - start:.3f} s, {found.mean():.1%} attainable")


if __name__ == "__main__":
    main()
