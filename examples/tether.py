"""A force of your own: the CUBE is pushed off, runs to the end of an elastic tether and is pulled back.

    python examples/tether.py

The energy is accounted for: what hull, water and tether hold, and what the drag has taken, add up to what there was.
"""

from pathlib import Path

import mujoco
import numpy as np
from scipy.integrate import cumulative_simpson

import cube_sim

MODEL = Path(__file__).parents[1] / "models" / "cube.xml"
ANCHOR = np.array([0.0, 0.0, 0.0])  # world axes [m]
EYE = np.array([-0.25, 0.0, 0.25])  # where the tether is made fast to the hull, body axes [m]
LENGTH, STIFFNESS = 1.0, 60.0  # slack up to 1 m, then 60 N/m


def tether(time, position, rotation, velocity, through_water):
    """The wrench in body axes at the body origin [N, N m]; compiled, since numba can."""
    line = position + rotation @ EYE - ANCHOR
    length = np.sqrt((line**2).sum())
    if length <= LENGTH:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    fx, fy, fz = rotation.T @ (-STIFFNESS * (length - LENGTH) / length * line)
    x, y, z = EYE
    return fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx


def energy(vehicle: cube_sim.Vehicle, data: mujoco.MjData) -> tuple[float, float, float]:
    """Of the motion (the water that moves along included), of weight and buoyancy, of the tether [J]."""
    rotation = data.xmat[vehicle.body].reshape(3, 3)
    position, nu = data.xpos[vehicle.body], body_velocity(vehicle, data)
    motion = 0.5 * nu @ (vehicle.mass_matrix + vehicle.added_mass) @ nu
    mass_height = (position + rotation @ vehicle.centre_of_mass)[2]
    buoyancy_height = (position + rotation @ vehicle.centre_of_buoyancy)[2]
    g = -vehicle.gravity[2]
    height = g * (vehicle.mass * mass_height - vehicle.displaced_mass * buoyancy_height)
    stretch = max(0.0, np.linalg.norm(position + rotation @ EYE - ANCHOR) - LENGTH)
    return motion, height, 0.5 * STIFFNESS * stretch**2


def body_velocity(vehicle: cube_sim.Vehicle, data: mujoco.MjData) -> np.ndarray:
    """nu (6,) in body axes; MuJoCo's free joint has its linear velocity in world axes."""
    rotation, v = data.xmat[vehicle.body].reshape(3, 3), data.qvel[vehicle.dof_address :][:6]
    return np.concatenate([v[:3] @ rotation, v[3:]])


def main() -> None:
    model = cube_sim.load_model(MODEL, forces={"hull": tether})
    vehicle = cube_sim.Vehicle.from_model(model)
    data = mujoco.MjData(model)
    data.qvel[:3] = 1.2, 0.3, 0.0  # pushed off
    distance, held, power = [], [], []
    for _ in range(801):
        mujoco.mj_forward(model, data)
        nu = body_velocity(vehicle, data)
        drag = vehicle.linear_damping @ nu + vehicle.quadratic_damping @ (np.abs(nu) * nu)
        distance.append(np.linalg.norm(data.xpos[vehicle.body] - ANCHOR))
        held.append(energy(vehicle, data))
        power.append(nu @ drag)
        mujoco.mj_step(model, data)

    lost = cumulative_simpson(power, dx=model.opt.timestep, initial=0.0)
    total = np.sum(held, axis=1) + lost
    print("                      ---------------------------- energy [J] ----------------------------")
    print("t [s]  distance [m]   motion   weight and buoyancy   tether   lost to drag            sum")
    for k in range(0, 801, 80):
        motion, height, stretch = held[k]
        print(
            f"{k * model.opt.timestep:5.1f}{distance[k]:14.3f}{motion:9.2f}{height:22.2f}{stretch:9.2f}"
            f"{lost[k]:15.2f}{total[k]:15.6f}"
        )
    print(f"the sum keeps to {np.ptp(total):.1e} J, of the {held[0][0]:.1f} J it was pushed off with")


if __name__ == "__main__":
    main()
