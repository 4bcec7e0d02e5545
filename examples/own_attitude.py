"""An attitude of your own: the nose turns into the current, as far as that is known, whichever way the path goes.

python examples/own_attitude.py, or in a scenario beside this file
`control: {attitude: {mode: python, python: own_attitude.py:into_the_current}}`

cube_sim's law estimates the current and asks for an attitude at each tick; it gets a quaternion, and may get its rates.
"""

from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.spatial import rotation_from_quaternion

ROOT = Path(__file__).parents[1]
CURRENT = np.array([0.1, -0.25, 0.0])


def into_the_current(setup, turning_s=8.0):
    heading = [None]

    def attitude(situation, dt):  # q_WD wxyz, and its angular velocity [rad/s], world axes
        if heading[0] is None:  # the vehicle's own at first
            heading[0] = np.arctan2(situation.rotation[1, 0], situation.rotation[0, 0])
        x, y, _ = -situation.current
        off = np.angle(np.exp(1j * (np.arctan2(y, x) - heading[0])))
        rate = off / turning_s * min(1.0, np.hypot(x, y) / 0.05)  # a current of nothing has no direction
        quaternion = np.cos(heading[0] / 2), 0.0, 0.0, np.sin(heading[0] / 2)
        heading[0] += rate * dt
        return quaternion, (0.0, 0.0, rate)

    return attitude


def main() -> None:
    settings = {
        "control.attitude": {"mode": "python", "python": f"{__file__}:into_the_current"},
        "current_m_s": CURRENT,
        "duration_s": 40,
        "checks": [
            {"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "from_s": 30, "at_most": 0.05},
            {"kind": "signal", "signal": "path_error.attitude", "statistic": "max", "from_s": 30, "at_most": 0.1},
            {"kind": "allowed_forces"},
        ],
    }
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", {**settings, **model})
        nose = rotation_from_quaternion(run.signals["pose.quaternion"][-1, 1:])[:, 0]
        off = np.degrees(np.arccos(-nose @ CURRENT / np.linalg.norm(CURRENT)))
        print(f"{vehicle}: {run.verdict}, {off:.1f} deg off the current at the end, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
