"""A control law of your own in six lines: a PID flies a helix, on two vehicles, and is judged as cube_sim's law is.

python examples/own_pid.py, or in a scenario beside this file `control: {law: {python: own_pid.py:pid}}`
"""

from pathlib import Path

import numpy as np

import cube_sim

ROOT = Path(__file__).parents[1]


def pid(setup, kp=2.0, ki=0.2, kd=3.0):
    M, total = setup.dynamics.total_mass, np.zeros(6)

    def law(aim):  # the wrench for one tick [N, N m], body axes
        error = np.clip(aim.error, -0.5, 0.5)  # far from the path its guidance knows the way
        total[:] += (error + aim.velocity_error) * aim.dt
        return M @ (kp * error + ki * total + kd * aim.velocity_error)

    return law


def main() -> None:
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", model, controller=pid)
        print(f"{vehicle}: {run.verdict}, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
