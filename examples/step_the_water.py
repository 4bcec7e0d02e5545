"""Step the water in a loop: the CUBE pushes against a current until its drag takes up the whole thrust.

python examples/step_the_water.py
"""

from math import sqrt
from pathlib import Path

import mujoco
import numpy as np

import cube_sim

MODEL = Path(__file__).parents[1] / "models" / "cube.xml"
THRUST_N = 40.0
CURRENT_M_S = (-0.1, 0.0, 0.0)  # world axes: it comes from ahead


def main() -> None:
    model = cube_sim.load_model(MODEL)  # an ordinary mujoco.MjModel; every step of it includes the water
    model.opt.wind[:] = CURRENT_M_S
    data = mujoco.MjData(model)
    vehicle = cube_sim.Vehicle.from_model(model)
    thrusters = vehicle.thrusters

    # F = A f has many solutions; this one has the least sum of squares.
    force = np.linalg.pinv(vehicle.actuation_matrix) @ [THRUST_N, 0, 0, 0, 0, 0]
    data.ctrl[thrusters.actuators] = thrusters.command(force)
    for name, f, command in zip(thrusters.names, force, thrusters.command(force), strict=True):
        print(f"{name}  {f:7.2f} N  command {command:6.3f}")

    print("\n  t [s]   x [m]   over ground [m/s]   through water [m/s]")
    steps_per_second = round(1.0 / model.opt.timestep)
    for second in range(16):
        position, velocity = data.qpos[:3], data.qvel[:3]  # of the free joint, in world axes
        if second % 3 == 0:
            print(f"{second:7d}{position[0]:8.2f}{velocity[0]:20.4f}{velocity[0] - CURRENT_M_S[0]:22.4f}")
        mujoco.mj_step(model, data, nstep=steps_per_second)

    # At the end nothing accelerates: d u + d_q u^2 = F, with u through the water.
    d, d_q = vehicle.linear_damping[0, 0], vehicle.quadratic_damping[0, 0]
    equilibrium = (-d + sqrt(d * d + 4.0 * d_q * THRUST_N)) / (2.0 * d_q)
    through_water = data.qvel[0] - CURRENT_M_S[0]
    print(f"\ndrag of {THRUST_N:g} N at {equilibrium:.4f} m/s; simulated: {through_water:.4f} m/s")


if __name__ == "__main__":
    main()
