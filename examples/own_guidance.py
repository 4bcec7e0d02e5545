"""A guidance law of your own: line of sight, towards a point of the path's tangent a few metres ahead of the target.

python examples/own_guidance.py, or in a scenario beside this file
`guidance: {law: {python: own_guidance.py:line_of_sight, options: {ahead: 3.0}}}`

Attitude, wrench and forces are cube_sim's. The target waits for the vehicle; the velocity is asked of the law at each
tick (Breivik and Fossen, Guidance laws for autonomous underwater vehicles, 2009).
"""

from pathlib import Path

import numpy as np

import cube_sim

ROOT = Path(__file__).parents[1]


def line_of_sight(setup, ahead=1.5, slowing_s=3.0):
    speed = setup.scenario.guidance.speed_m_s

    def velocity(view):  # over ground [m/s], world axes
        way = np.array([ahead, 0.0, 0.0]) - view.error  # in the path's frame: T, N1, N2
        pace = min(speed, max(view.remaining - view.error[0], 0.0) / slowing_s)
        return view.point.rotation @ (pace * way / np.linalg.norm(way))

    return velocity


def main() -> None:
    settings = {
        "guidance.law": {"python": f"{__file__}:line_of_sight", "options": {"ahead": 1.0}},
        "duration_s": 50,
        "checks": [
            {"kind": "signal", "signal": "path_error.cross_track", "statistic": "rms", "from_s": 30, "at_most": 0.1},
            {"kind": "allowed_forces"},
        ],
    }
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", {**settings, **model})
        print(f"{vehicle}: {run.verdict}, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
