"""What of a vehicle is too stiff for a model's time step: drag, lift, servos of joints."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.vehicle.servo_stiffness import NEAR, stiff_servo_words
from cube_sim.vehicle.vehicle import Vehicle

USUAL_SPEED_M_S = 1.0
"""Speed at which drag is looked at (a choice)."""
_RK4_LIMIT, _EULER_LIMIT = 2.785, 2.0  # of slope * step / mass, beyond which the motion explodes


def stiff_words(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    """Sentences on the drag and lift of a vehicle, and on its servos, where they are too stiff for the time step.

    Args:
        model: made by `load_model`, with the time step and integrator that it is flown with.
        vehicle: a hull of it.
    """
    return [*_stiff_water(model, vehicle), *stiff_servo_words(model, vehicle.body)]


def _stiff_water(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    slope = vehicle.linear_damping + 2.0 * USUAL_SPEED_M_S * vehicle.quadratic_damping
    parts = [("its drag", slope)]
    if vehicle.lift is not None:
        none = np.zeros((6, 6, 6))
        parts += [
            ("the lift of its fins", slope + _steepest(vehicle, slope, none, vehicle.lift.fins)),
            (
                "the lift and drag of its strips and velocity products",
                slope + _steepest(vehicle, slope, vehicle.lift.products, vehicle.lift.absolute),
            ),
        ]
    limit = _RK4_LIMIT if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else _EULER_LIMIT
    for what, steep in parts:
        stiffness = _fastest(vehicle, steep) * model.opt.timestep
        if stiffness > NEAR * limit:
            return [
                f"{what} at {USUAL_SPEED_M_S:g} m/s or rad/s is stiff for the time step of {model.opt.timestep:g} s: "
                f"{stiffness:.2g} of {limit:g}, beyond which the motion explodes; take a step of "
                f"{0.1 * limit * model.opt.timestep / stiffness:.2g} s, a tenth of the longest (a scenario's "
                "physics.step_s)"
            ]
    return []


def _fastest(vehicle: Vehicle, slope: np.ndarray) -> float:
    """The largest rate [1/s] at which a slope of force by velocity (6,6) changes the motion."""
    rates = np.linalg.eigvals(np.linalg.solve(vehicle.mass_matrix + vehicle.added_mass, slope))
    return float(np.abs(rates).max())


def _steepest(vehicle: Vehicle, slope: np.ndarray, signed: np.ndarray, absolute: np.ndarray) -> np.ndarray:
    """(6,6) the steepest slope of P nu nu + Q nu |nu|, of flows along each axis, taken with another slope."""
    found = []
    for flow in USUAL_SPEED_M_S * np.eye(6)[:3]:
        of_signed = np.einsum("ijk,k->ij", signed, flow) + np.einsum("ijk,j->ik", signed, flow)
        of_first = np.einsum("ijk,k->ij", absolute, np.abs(flow))
        of_second = np.einsum("ijk,j,k->ik", absolute, flow, np.sign(flow))
        found.append(-(of_signed + of_first + of_second))
    return max(found, key=lambda more: _fastest(vehicle, slope + more))
