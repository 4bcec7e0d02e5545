"""What is worth a word about a vehicle's own numbers: weight against buoyancy, its attitude at rest, stiff drag."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.vehicle.floating import floating_height
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle

NEUTRAL = 1e-3
"""Share of its weight by which a vehicle's buoyancy may differ and still be called neutral (a choice)."""
TILTED_DEG = 3.0
"""Tilt at rest that is worth a word (a choice)."""
LEAST_ARM_M = 1e-6
"""Height of the centre of buoyancy over that of mass that rights a hull at all (a choice)."""
USUAL_SPEED_M_S = 1.0
"""Speed at which drag is looked at (a choice)."""
_RK4_LIMIT, _EULER_LIMIT = 2.785, 2.0  # of slope * step / mass, beyond which the motion explodes
_NEAR = 0.5  # share of the limit that is worth a word


def remarks(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    """Sentences on a hull left to itself, and on what no analysis looks at."""
    g = float(np.linalg.norm(vehicle.gravity))
    weight, lift = vehicle.mass * g, vehicle.displaced_mass * g
    said = [_buoyancy(model, vehicle, weight, lift)]
    if g > 0.0:
        said += _at_rest(lift * vehicle.centre_of_buoyancy - weight * vehicle.centre_of_mass, weight)
    return said + _stiff(model, vehicle) + _own_force(model, vehicle)


def _buoyancy(model: mujoco.MjModel, vehicle: Vehicle, weight: float, lift: float) -> str:
    less = lift - weight
    text = f"weighs {weight:.4g} N, displaces {lift:.4g} N of water"
    if abs(less) <= NEUTRAL * weight:
        return f"{text}: neutral"
    if less < 0.0:
        return f"{text}: sinks with {-less:.3g} N"
    below = -floating_height(model, vehicle)
    return f"{text}: rises with {less:.3g} N; floats with its origin {below:.2g} m below the surface"


def _at_rest(righting: np.ndarray, weight: float) -> list[str]:
    size = float(np.linalg.norm(righting))
    if size <= LEAST_ARM_M * weight:
        return ["its centre of buoyancy lies in its centre of mass: nothing rights it"]
    tilt = float(np.degrees(np.arccos(np.clip(righting[2] / size, -1.0, 1.0))))
    if tilt <= TILTED_DEG:
        return []
    across = float(np.linalg.norm(righting[:2]))
    return [f"left to itself it rests tilted by {tilt:.0f} deg; level it has to be held with {across:.3g} N m"]


def _stiff(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    slope = vehicle.linear_damping + 2.0 * USUAL_SPEED_M_S * vehicle.quadratic_damping
    rates = np.linalg.eigvals(np.linalg.solve(vehicle.mass_matrix + vehicle.added_mass, slope))
    limit = _RK4_LIMIT if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else _EULER_LIMIT
    stiffness = float(np.abs(rates).max()) * model.opt.timestep
    if stiffness <= _NEAR * limit:
        return []
    return [
        f"its drag at {USUAL_SPEED_M_S:g} m/s or rad/s is stiff for the time step of {model.opt.timestep:g} s: "
        f"{stiffness:.2g} of {limit:g}, beyond which the motion explodes; take a step of "
        f"{0.1 * limit * model.opt.timestep / stiffness:.2g} s"
    ]


def _own_force(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    packed = packing.packed_parameters(model)
    start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
    for record in packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE):
        if record[layout.BODY] == vehicle.body and record[layout.FORCE] >= 0.0:
            return [f"{vehicle.name}:force is not looked at here: it acts in flight, and no controller knows it"]
    return []
