"""Fly every loss of one, two and three thrusters, or four, and compare with what the actuation analysis predicted.

    python benchmarks/survival.py --losses 4
    python benchmarks/survival.py --out logs/survival
    python benchmarks/survival.py --set current_m_s=[0,0.4,0] --set model=../models/bluerov2_heavy.xml

Each loss flies scenarios/cube_survival.yaml with its thrusters dying at 20 s; the figure is the cross-track RMS from
45 s on. The analysis is asked beforehand, from the actuation matrix and the limits alone. Writes survival.csv, and
survival.png: singles and pairs as a matrix, larger losses as a list.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cube_survival.yaml"
FAILURE_S, JUDGED_FROM_S, LIMIT_M = 20.0, 45.0, 0.5


class Flight(NamedTuple):
    """One loss, flown.

    Attributes:
        lost: names of the dead thrusters.
        authority: how the vehicle flew at the end.
        rms_m: cross-track RMS after recovery [mm], None when the run could not be judged.
        worst_m: largest cross-track error after recovery [m].
        predicted: whether the analysis expected it to follow the path.
        reason: of the prediction.
    """

    lost: tuple[str, ...]
    authority: str
    rms_m: float | None
    worst_m: float | None
    predicted: bool
    reason: str

    @property
    def survived(self) -> bool:
        """Whether the path was followed."""
        return self.rms_m is not None and self.rms_m <= LIMIT_M


def fly(losses: list[tuple[str, ...]], settings: dict[str, Any], threads: int) -> list[Flight]:
    """Fly each loss, beside what the analysis expects of it."""
    import cube_sim
    from cube_sim.control.authority import Authority

    judged = {"kind": "signal", "signal": "path_error.cross_track", "from_s": JUDGED_FROM_S, "at_most": 9e9}
    checks = [judged | {"statistic": statistic} for statistic in ("rms", "max")]
    failures = [[{"kind": "thrusters", "at_s": FAILURE_S, "thrusters": [*lost], "state": "dead"}] for lost in losses]
    varied = [settings | {"events": events, "checks": checks} for events in failures]
    expected, flights = predictions(settings, max(map(len, losses))), []
    flown = cube_sim.fly_many(SCENARIO, varied, threads=threads, signals=["health.authority"])
    for lost, outcome in zip(losses, flown, strict=True):
        rms, worst = (check.value for check in outcome.checks)
        authority = Authority(int(outcome.signals["health.authority"][-1, 1])).name
        flights.append(Flight(lost, authority, rms, worst, *expected[lost]))
    return flights


def predictions(settings: dict[str, Any], most: int) -> dict[tuple[str, ...], tuple[bool, str]]:
    """Lost thrusters -> what the analysis expects of the vehicle, at the mission's own speed and limits."""
    from cube_sim.actuation import PathRequirements, survivability
    from cube_sim.scenario import load
    from cube_sim.vehicle.loading import load_model
    from cube_sim.vehicle.vehicle import Vehicle

    scenario = load(SCENARIO, settings).scenario
    zone = scenario.thrusters.dead_zone_N
    vehicle = Vehicle.from_model(load_model(scenario.model))
    limits = vehicle.thrusters.limits.copy()
    if zone is not None:
        limits[:, 1:3] = zone
    table = survivability(
        vehicle.actuation_matrix,
        limits,
        names=vehicle.thrusters.names,
        hull=vehicle.dynamics,
        most=most,
        requirements=PathRequirements(speed_m_s=scenario.guidance.speed_m_s),
    )
    return {case.lost: (case.verdict.follows, case.verdict.reason) for case in table.cases if case.lost}


def main() -> None:
    """Fly all losses and write the table and the picture."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("logs/survival"), help="folder for the table and the picture")
    parser.add_argument(
        "--losses", type=int, nargs="+", default=[1, 2, 3], choices=[1, 2, 3, 4], help="how many at once"
    )
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1, help="flights at a time")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="a value of the scenario: current_m_s=[0,0.4,0]"
    )
    arguments = parser.parse_args()
    if arguments.threads < 1:
        parser.error("--threads must be 1 at least")

    from cube_sim.commands.settings import overrides
    from cube_sim.errors import CubeSimError

    try:
        settings = overrides(arguments.set)
        names = sorted({name for lost in predictions(settings, 1) for name in lost})
        losses = [lost for n in arguments.losses for lost in combinations(names, n)]
        ordered = fly(losses, settings, arguments.threads)
    except CubeSimError as error:
        sys.exit(str(error))
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_table(ordered, arguments.out / "survival.csv")
    draw(ordered, names, arguments.out / "survival.png")
    print_summary(ordered, arguments.out)


def write_table(flights: list[Flight], path: Path) -> None:
    """One row per loss."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["lost", "authority", "rms_m", "worst_m", "survived", "predicted", "reason"])
        for f in flights:
            figures = ["" if value is None else f"{value:.4f}" for value in (f.rms_m, f.worst_m)]
            writer.writerow(["+".join(f.lost), f.authority, *figures, f.survived, f.predicted, f.reason])


def print_summary(flights: list[Flight], out: Path) -> None:
    """Counts per number of losses, and every flight the analysis did not foresee."""
    for n in sorted({len(f.lost) for f in flights}):
        group = [f for f in flights if len(f.lost) == n]
        worst = max((f.rms_m for f in group if f.survived and f.rms_m is not None), default=float("nan"))
        print(
            f"{n} lost: {sum(f.survived for f in group)} of {len(group)} within {LIMIT_M:g} m cross-track RMS"
            f" (largest of these {worst:.3f} m); {sum(f.predicted for f in group)} predicted to follow"
        )
    for f in flights:
        if not f.survived:
            figure = "not judged" if f.rms_m is None else f"{f.rms_m:.2f} m"
            foreseen = "NOT foreseen" if f.predicted else "foreseen"
            print(f"  {'+'.join(f.lost)}: {figure} as {f.authority}, {foreseen}: {f.reason}")
    print(f"table and picture: {out}")


def draw(flights: list[Flight], names: list[str], path: Path) -> None:
    """Singles on the diagonal and pairs off it as a matrix; larger losses as bars."""
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot as plt
    from matplotlib.colors import LogNorm

    rms = {f.lost: np.nan if f.rms_m is None else 1e3 * f.rms_m for f in flights}
    matrix = np.full((len(names), len(names)), np.nan)
    for lost, value in rms.items():
        if len(lost) in (1, 2):
            i, j = names.index(lost[0]), names.index(lost[-1])
            matrix[i, j] = matrix[j, i] = value
    many = sorted((f for f in flights if len(f.lost) > 2), key=lambda f: (len(f.lost), rms[f.lost]))
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.6), width_ratios=(1.0, 1.25), layout="constrained")
    image = left.imshow(matrix, cmap="viridis", norm=LogNorm(0.1, 1000.0))
    left.set_xticks(range(len(names)), names)
    left.set_yticks(range(len(names)), names)
    for (i, j), value in np.ndenumerate(matrix):
        if np.isfinite(value):
            left.text(j, i, f"{value:.2g}", ha="center", va="center", fontsize=8, color="w" if value < 30.0 else "k")
    left.set_title("one lost (diagonal) and two lost")
    figure.colorbar(image, ax=left, label="cross-track RMS after recovery [mm]", shrink=0.85)
    if many:
        colours = ["#0072b2" if f.predicted else "#d55e00" for f in many]
        right.bar(range(len(many)), [rms[f.lost] for f in many], color=colours)
        right.set_xticks(range(len(many)), ["".join(f.lost).replace("T", "") for f in many], rotation=90, fontsize=7)
        right.axhline(1e3 * LIMIT_M, color="k", lw=0.8, ls="--")
        right.set_yscale("log")
        right.set_ylabel("cross-track RMS after recovery [mm]")
        right.set_title("three and more lost: blue predicted to follow, orange predicted not to")
    figure.savefig(path, dpi=140)


if __name__ == "__main__":
    main()
