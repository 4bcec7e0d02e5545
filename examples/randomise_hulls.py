"""Randomise the water of each simulation: 32 CUBEs of unlike added mass and drag, stepped together on threads.

python examples/randomise_hulls.py
"""

import copy
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch

import cube_sim

MODEL = Path(__file__).parents[1] / "models" / "cube.xml"
HULLS, SHOWN = 32, 5
THRUST_N = 40.0


def random_model(nominal: mujoco.MjModel, rng: np.random.Generator) -> mujoco.MjModel:
    """A copy, compiled no more, of the CUBE with its added mass and its quadratic drag off by up to 30 %.

    The three axes keep one factor. With one each, the Munk moment turns those hulls broadside whose added mass is
    smaller ahead than across: try it.
    """
    model, vehicle = copy.copy(nominal), cube_sim.Vehicle.from_model(nominal)
    parameters = {  # named as in the MJCF; six values are a diagonal
        "hull:added_mass": vehicle.added_mass.diagonal() * rng.uniform(0.7, 1.3),
        "hull:quadratic_damping": vehicle.quadratic_damping.diagonal() * rng.uniform(0.7, 1.3),
    }
    cube_sim.set_parameters(model, parameters)
    return model


def main() -> None:
    rng = np.random.default_rng(1)
    nominal = cube_sim.load_model(MODEL)
    models = [random_model(nominal, rng) for _ in range(HULLS)]
    vehicles = [cube_sim.Vehicle.from_model(model) for model in models]

    # A model carries the numbers of its water: MuJoCo's own batch steps each hull in its own, free of Python's lock.
    fleet = Batch(models[0], nsim=HULLS, nthread=2)
    fleet.set_models(models)
    thrusters = vehicles[0].thrusters
    force = np.linalg.pinv(vehicles[0].actuation_matrix) @ [THRUST_N, 0, 0, 0, 0, 0]
    fleet.ctrl[:, thrusters.actuators] = thrusters.command(force)
    steps_per_second = round(1.0 / models[0].opt.timestep)
    fleet.step(nstep=steps_per_second)
    early = fleet.qvel[:, 0].copy()
    fleet.step(nstep=14 * steps_per_second)
    late = fleet.qvel[:, 0].copy()

    a, d, d_q = (
        np.array([getattr(vehicle, name)[0, 0] for vehicle in vehicles])
        for name in ("added_mass", "linear_damping", "quadratic_damping")
    )
    equilibrium = (-d + np.sqrt(d**2 + 4.0 * d_q * THRUST_N)) / (2.0 * d_q)  # d u + d_q u^2 = F
    print("hull   added mass [kg]   drag [N s^2/m^2]   u(1 s) [m/s]   u(15 s)   equilibrium")
    for k in range(SHOWN):
        print(f"{k:4d}{a[k]:18.1f}{d_q[k]:19.1f}{early[k]:15.4f}{late[k]:10.4f}{equilibrium[k]:14.4f}")
    print(" ...")
    for name, u in (("u(1 s)", early), ("u(15 s)", late)):
        print(f"{name:8} mean {u.mean():.4f}, standard deviation {u.std():.4f}, {u.min():.4f} to {u.max():.4f} m/s")
    print(f"largest difference of u(15 s) from equilibrium: {np.abs(late - equilibrium).max():.1e} m/s")


if __name__ == "__main__":
    main()
