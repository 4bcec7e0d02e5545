"""What the MJCF says of lift and cross-flow drag of a hull.

<body>:velocity_products        rows axis, j, k, c: F_axis += c nu_j nu_k, each 1 to 6 (surge, sway, heave, roll, pitch,
                                yaw; body axes, relative to the water), c nu_j |nu_k| for a k with a minus
<body>:coriolis_of_added_mass   0 where the products have Munk moment and Coriolis of the added mass in them, as
                                tables of manoeuvring derivatives do; else 1, or left out
<body>:cross_flow_stations      rows x, breadth, height [m] of the hull, x increasing, from end to end
<body>:cross_flow_drag          C_Dy, C_Dz of the flow across it, against the height and against the breadth
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.mjcf.numbers import Numerics, rows, scalar, vector

PRODUCTS, CORIOLIS = "velocity_products", "coriolis_of_added_mass"
STATIONS, CROSS_FLOW = "cross_flow_stations", "cross_flow_drag"

_DEGREES_OF_FREEDOM = 6


def velocity_products(numerics: Numerics, body: str, added_mass: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,5) axis, j, k (0 to 5), whether |nu_k| is meant, and c; what the switch leaves out is in them.

    Args:
        numerics: name -> values (n,).
        body: the hull.
        added_mass: M_A (6,6).

    Raises:
        ModelError: names the numeric and says what would be right.
    """
    name = f"{body}:{PRODUCTS}"
    found: dict[tuple[int, int, int, bool], float] = {}
    for axis, first, second, coefficient in rows(numerics, name, 4, "axis, j, k, coefficient").tolist():
        _add(found, *product_of(name, axis, first, second), coefficient)
    if not _keeps_coriolis(numerics, body):
        for i, j, k, coefficient in coriolis_products(added_mass):
            _add(found, i, j, k, False, coefficient)
    return np.array([[*key, value] for key, value in sorted(found.items()) if value]).reshape(-1, 5)


def product_of(name: str, axis: float, first: float, second: float) -> tuple[int, int, int, bool]:
    """axis, j and k (0 to 5), and whether |nu_k| is meant, of a row that has them from 1, k with a minus for |nu_k|.

    Raises:
        ModelError: they are not 1 to 6; names the numeric.
    """
    numbers = axis, first, abs(second)
    if any(number != int(number) or not 1 <= number <= _DEGREES_OF_FREEDOM for number in numbers):
        told = f"{axis:g} {first:g} {second:g}"
        raise ModelError(name, f"has a row that begins {told}; axis, j and k are 1 to 6 (k with a minus: |nu_k|)")
    i, j, k = (int(number) - 1 for number in numbers)
    return i, j, k, second < 0.0


def strips(numerics: Numerics, body: str, density: float) -> NDArray[np.float64]:
    """(n,3) x [m], and rho/2 C_D A [kg/m] of the area across y and across z, by the trapezoidal rule.

    Args:
        numerics: name -> values (n,).
        body: the hull.
        density: of the water [kg/m^3].

    Raises:
        ModelError: names the numeric and says what would be right.
    """
    name, drag = f"{body}:{STATIONS}", f"{body}:{CROSS_FLOW}"
    stations = rows(numerics, name, 3, "x, breadth, height [m]")
    if not len(stations):
        if drag in numerics:
            raise ModelError(drag, f"has no hull to act on; it takes '{name}', rows x, breadth, height [m]")
        return np.empty((0, 3))
    if drag not in numerics:
        raise ModelError(drag, f"is missing; '{name}' needs C_Dy and C_Dz")
    across = vector(numerics, drag, 2)
    if np.any(across < 0.0) or np.any(stations[:, 1:] < 0.0):
        raise ModelError(drag if np.any(across < 0.0) else name, "has a negative value; drag takes energy out")
    x = stations[:, 0]
    if len(x) < 2 or np.any(np.diff(x) <= 0.0):
        raise ModelError(name, "has stations out of order; two or more, x increasing, are right")
    gaps = np.diff(x)
    lengths = 0.5 * (np.append(gaps, 0.0) + np.insert(gaps, 0, 0.0))
    sideways = 0.5 * density * across[0] * stations[:, 2] * lengths
    upwards = 0.5 * density * across[1] * stations[:, 1] * lengths
    return np.column_stack([x, sideways, upwards])


def _keeps_coriolis(numerics: Numerics, body: str) -> bool:
    name = f"{body}:{CORIOLIS}"
    if name not in numerics:
        return True
    value = scalar(numerics, name)
    if value not in (0.0, 1.0):
        raise ModelError(name, f"is {value:g}; 0, for a table that has it, or 1 is right")
    return value == 1.0


def coriolis_products(added_mass: NDArray[np.float64]) -> list[tuple[int, int, int, float]]:
    """+C_A(nu) nu as products (axis, j, k, c): what takes -C_A(nu) nu out again.

    C_A(nu) nu = [w x p; v x p + w x h], [p; h] = M_A nu (`cube_sim.vehicle.laws.hydrodynamics.coriolis`).
    """
    products = []
    for force, velocity, momentum in ((0, 3, 0), (3, 0, 0), (3, 3, 3)):
        for i in range(3):
            a, b = (i + 1) % 3, (i + 2) % 3
            for k in range(6):
                products.append((force + i, velocity + a, k, float(added_mass[momentum + b, k])))
                products.append((force + i, velocity + b, k, -float(added_mass[momentum + a, k])))
    return products


def _add(found: dict[tuple[int, int, int, bool], float], i: int, j: int, k: int, absolute: bool, value: float) -> None:
    key = (i, j, k, True) if absolute else (i, min(j, k), max(j, k), False)
    found[key] = found.get(key, 0.0) + value
