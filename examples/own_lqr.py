"""A control law of your own that uses MuJoCo: an LQR of the water, linearised by mjd_transitionFD, on two vehicles.

python examples/own_lqr.py, or in a scenario beside this file `control: {law: {python: own_lqr.py:lqr}}`
"""

from pathlib import Path

import mujoco
import numpy as np
from scipy.linalg import solve_discrete_are

import cube_sim

ROOT = Path(__file__).parents[1]


def lqr(setup, position=4.0, attitude=8.0, velocity=4.0, rates=2.0, farthest=0.5):
    A, B = linearised(setup)
    M = setup.dynamics.total_mass
    Q = np.diag(np.repeat([position, attitude, velocity, rates], 3))  # [1/m^2], [1], [s^2/m^2], [s^2]
    R = np.linalg.inv(M @ M)  # accelerations count, not forces
    P = solve_discrete_are(A, B, Q, R)
    K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)

    def law(aim):
        error = np.concatenate([aim.error, aim.velocity_error])
        error[:3] *= min(1.0, farthest / max(np.linalg.norm(error[:3]), 1e-9))  # far away nothing is linear
        steady = setup.dynamics.wrench(aim.state.rotation, aim.velocity, np.zeros(6), np.zeros(3))
        return steady + K @ error

    return law


def linearised(setup):
    """x' = A x + B w over one control period, about rest: x is pose and velocity of the hull, w a wrench on it."""
    model, dof = setup.model, setup.vehicle.dof_address
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # mjd_transitionFD takes no RK4
    model.opt.timestep = setup.period_s
    data = mujoco.MjData(model)
    n = model.nv
    A = np.zeros((2 * n + model.na, 2 * n + model.na))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, A, None, None, None)
    hull = np.concatenate([np.arange(dof, dof + 6), n + np.arange(dof, dof + 6)])
    faster = setup.period_s * np.linalg.inv(setup.dynamics.total_mass)  # by 1 N or 1 N m
    return A[np.ix_(hull, hull)], np.vstack([setup.period_s * faster, faster])


def main() -> None:
    for vehicle in ("cube", "bluerov2_heavy"):
        model = {"model": ROOT / "models" / f"{vehicle}.xml"}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", model, controller=lqr)
        print(f"{vehicle}: {run.verdict}, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
