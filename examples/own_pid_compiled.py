"""The PID of own_pid.py compiled: it flies in the compiled loop, without Python at a tick.

python examples/own_pid_compiled.py, or in a scenario beside this file
`control: {law: {python: own_pid_compiled.py:pid}}`

What the law reads and what it remembers stand beside it, as records; it is told what a law of Python's is told.
"""

from pathlib import Path

import numpy as np

import cube_sim

ROOT = Path(__file__).parents[1]


def pid(setup, kp=2.0, ki=0.2, kd=3.0):
    parameters = {"M": setup.dynamics.total_mass, "kp": kp, "ki": ki, "kd": kd}
    return cube_sim.compiled(law, parameters, memory={"total": np.zeros(6)})


def law(aim, p, m):  # the wrench for one tick [N, N m], body axes
    error = np.clip(aim.error, -0.5, 0.5)  # far from the path its guidance knows the way
    m.total += (error + aim.velocity_error) * aim.dt
    return p.M @ (p.kp * error + p.ki * m.total + p.kd * aim.velocity_error)


def main() -> None:
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", model, controller=pid)
        print(f"{vehicle}: {run.verdict}, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
