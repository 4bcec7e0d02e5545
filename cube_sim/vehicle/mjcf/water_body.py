"""The water on one rigid body, a hull or a link that it carries, as the MJCF states it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.vehicle.mjcf.damping import require_dissipative, require_pairwise_dissipative
from cube_sim.vehicle.mjcf.numbers import scalar, vector


@dataclass(frozen=True)
class WaterBody:
    """One body in the water; matrices are in body axes at the body origin.

    Attributes:
        body: its name.
        volume: V, displaced [m^3].
        displaced_mass: rho V [kg].
        centre_of_buoyancy: r_CB (3,) [m], body axes.
        added_mass: M_A (6,6) [kg, kg m, kg m^2], symmetric positive semidefinite.
        linear_damping: D (6,6) [N s/m, N s, N m s].
        quadratic_damping: D_q (6,6) [N s^2/m^2, ...], acting on |nu_r| nu_r.
        surface_half_axes: (3,) of the ellipsoid over which V is spread [m]; None where the geoms say them.
    """

    body: str
    volume: float
    displaced_mass: float
    centre_of_buoyancy: NDArray[np.float64]
    added_mass: NDArray[np.float64]
    linear_damping: NDArray[np.float64]
    quadratic_damping: NDArray[np.float64]
    surface_half_axes: NDArray[np.float64] | None


def water_body(numerics: Mapping[str, NDArray[np.float64]], body: str, density: float) -> WaterBody:
    """Read one body's numerics.

    Args:
        numerics: name -> values (n,).
        body: its name.
        density: of the water [kg/m^3].

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    if f"{body}:volume" not in numerics:
        raise ModelError(
            f"{body}:volume", f"is missing; '{body}' needs the volume it displaces [m^3], 0 for one that does not float"
        )
    volume = scalar(numerics, f"{body}:volume")
    if volume < 0.0:
        raise ModelError(f"{body}:volume", f"is {volume:g}; a volume [m^3] is not negative")
    added_mass = _matrix(numerics, f"{body}:added_mass")
    _require_symmetric(f"{body}:added_mass", added_mass)
    linear = _matrix(numerics, f"{body}:linear_damping")
    quadratic = _matrix(numerics, f"{body}:quadratic_damping")
    require_dissipative(f"{body}:linear_damping", linear)
    require_pairwise_dissipative(f"{body}:quadratic_damping", quadratic)
    return WaterBody(
        body=body,
        volume=volume,
        displaced_mass=density * volume,
        centre_of_buoyancy=vector(numerics, f"{body}:centre_of_buoyancy", 3),
        added_mass=0.5 * (added_mass + added_mass.T),  # to the last digit: rows are read as columns
        linear_damping=linear,
        quadratic_damping=quadratic,
        surface_half_axes=_half_axes(numerics, f"{body}:surface_half_axes"),
    )


def _half_axes(numerics: Mapping[str, NDArray[np.float64]], name: str) -> NDArray[np.float64] | None:
    if name not in numerics:
        return None
    half_axes = vector(numerics, name, 3)
    if half_axes.min() <= 0.0:
        raise ModelError(name, f"is {' '.join(f'{a:g}' for a in half_axes)}; half-axes [m] are positive")
    return half_axes


def _matrix(numerics: Mapping[str, NDArray[np.float64]], name: str) -> NDArray[np.float64]:
    values = numerics.get(name, np.zeros(6))
    if values.size == 6:
        return np.diag(values)
    if values.size == 36:
        return values.reshape(6, 6).copy()
    raise ModelError(
        name,
        f"has {counted(values.size, 'value')}; it takes 6 (a diagonal) or 36 (a full matrix by rows)",
    )


def _require_symmetric(name: str, matrix: NDArray[np.float64]) -> None:
    scale = float(np.abs(matrix).max(initial=0.0))
    if np.abs(matrix - matrix.T).max() > 1e-9 * scale:
        i, j = np.unravel_index(np.argmax(np.abs(matrix - matrix.T)), matrix.shape)
        raise ModelError(
            name,
            f"is not symmetric: entry ({i + 1},{j + 1}) is {matrix[i, j]:g}, ({j + 1},{i + 1}) is {matrix[j, i]:g}",
        )
    lowest = float(np.linalg.eigvalsh(matrix)[0])
    if lowest < -1e-9 * scale:
        raise ModelError(
            name,
            f"is not positive semidefinite (lowest eigenvalue {lowest:g}); kinetic energy is never negative",
        )
