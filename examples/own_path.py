"""A path of your own: a trefoil knot, followed by two vehicles.

python examples/own_path.py, or in a scenario beside this file
`path: {type: python, python: own_path.py:trefoil, options: {size: 2.0}, laps: 1}`
"""

from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.guidance.tabulation import Piece, tabulate

ROOT = Path(__file__).parents[1]
CHECKS = [
    {"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "from_s": 10, "at_most": 0.1},
    {"kind": "path_end", "reach_m": 0.2},
    {"kind": "allowed_forces"},
]


def trefoil(size=1.0, centre=(0.0, 0.0, -8.0)):
    def derivative(u):  # of size * (sin u + 2 sin 2u, cos u - 2 cos 2u, -sin 3u), (k,) -> (k, 3)
        return size * np.stack([np.cos(u) + 4 * np.cos(2 * u), 4 * np.sin(2 * u) - np.sin(u), -3 * np.cos(3 * u)], 1)

    start = np.array(centre) + size * np.array([0.0, -1.0, 0.0])
    return tabulate(start, [Piece(derivative, 2.0 * np.pi)], closed=True)


def main() -> None:
    start = trefoil().at(0.0)
    settings = {"path.laps": 1, "duration_s": 110, "checks": CHECKS, "initial.position_m": start.position}
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", {**settings, **model}, path=trefoil)
        print(f"{vehicle}: {run.verdict}, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
