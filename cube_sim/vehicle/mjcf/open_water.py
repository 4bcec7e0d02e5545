"""Open-water characteristics of propellers in an MJCF: K_T and K_Q by the advance ratio J.

A propeller that pushes takes power from its shaft. One that pushed and was turned by the water at once would make power
out of nothing, so K_Q is not negative as long as K_T is above 0, from J = 0 on. Beyond, it may turn by itself.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.vehicle.mjcf.numbers import Numerics, rows, vector

LINEAR, OPEN_WATER = "propeller_linear", "propeller_open_water"
_SAMPLES = 400
"""Of J, where the best efficiency is looked for."""
_LEAST = 1e-9
"""J K_T below which it is rounding, where K_T reaches 0."""


def open_water_rows(numerics: Numerics, linear: str | None, table: str | None, actuator: str) -> NDArray[np.float64]:
    """(n,3) J, K_T, K_Q of a propeller that turns ahead, of the one of its two numerics that is there.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        linear: the numeric with a_T, b_T, a_Q, b_Q; None where there is none.
        table: the one with rows; None where there is none.
        actuator: the propeller.

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    if linear is not None and table is not None and linear.partition(":")[0] != table.partition(":")[0]:
        its_own = f"{actuator}:"
        linear, table = (linear if linear.startswith(its_own) else None), (table if table.startswith(its_own) else None)
    if linear is not None and table is not None:
        raise ModelError(linear, f"stands beside {table}; one of the two is right")
    if table is not None:
        return open_water_table(numerics, table)
    if linear is None:
        raise ModelError(
            f"{actuator}:{OPEN_WATER}",
            f"is missing; propeller '{actuator}' needs its rows J, K_T, K_Q, or {LINEAR}: a_T b_T a_Q b_Q",
        )
    a_T, b_T, a_Q, b_Q = vector(numerics, linear, 4).tolist()
    if not (a_T > 0.0 and b_T <= 0.0):
        raise ModelError(linear, f"has K_T = {a_T:g} + {b_T:g} J; K_T above 0 at J = 0 that falls with J is right")
    lines = np.array([[0.0, a_T, a_Q], [1.0, a_T + b_T, a_Q + b_Q]])
    _require_torque(linear, lines)
    return lines


def _require_torque(name: str, table: NDArray[np.float64]) -> None:
    """Refuse a propeller that the water turns while it pushes: thrust and power at once, out of nothing."""
    for J, K_Q in _pushing(table):
        if K_Q < 0.0:
            beyond = ", as its last line goes on" if table[-1, 0] < J else ""
            raise ModelError(name, f"has K_Q = {K_Q:.3g} at J = {J:.3g}, where it pushes{beyond}; 0 or more is right")


def open_water_table(numerics: Numerics, name: str, of: str = "") -> NDArray[np.float64]:
    """(n,3) rows J, K_T, K_Q; arguments and errors as those of `open_water_rows`, `of` whose they are in words."""
    table = rows(numerics, name, 3, "J, K_T, K_Q")
    if len(table) < 2:
        raise ModelError(name, f"has {counted(len(table), 'row')} J, K_T, K_Q; two at least are right")
    J, K_T = table[:, 0], table[:, 1]
    if np.any(np.diff(J) <= 0.0):
        i = int(np.argmax(np.diff(J) <= 0.0))
        raise ModelError(name, f"goes from J = {J[i]:g} to {J[i + 1]:g} in row {i + 2}; J increases from row to row")
    bollard = at_zero_advance(table)[0]
    if J[0] > 0.0 or J[-1] < 0.0 or bollard <= 0.0:
        right = f"rows {of}from J = 0 or below, with K_T above 0 there, are right"
        raise ModelError(name, f"has K_T = {bollard:g} at J = 0; {right}")
    for i in range(len(table) - 1):
        b = (K_T[i + 1] - K_T[i]) / (J[i + 1] - J[i])
        if b > 0.0 and J[i + 1] > 0.0:
            raise ModelError(
                name,
                f"rises from K_T = {K_T[i]:g} to {K_T[i + 1]:g} in row {i + 2}; where J is above 0, K_T falls",
            )
        # dT/dn = rho D^4 n (2 K_T - J dK_T/dJ) where it pushes; the line before the first row goes on for ever.
        ends = [(J[i], K_T[i]), (J[i + 1], K_T[i + 1])] + (
            [(2.0 * J[0] - J[1], K_T[0] - b * (J[1] - J[0]))] if i == 0 else []
        )
        if any(k > 0.0 and 2.0 * k - j * b <= 0.0 for j, k in ends):
            raise ModelError(
                name, f"makes no more thrust with more turns about J = {J[i]:g} (row {i + 1}); it would not steer"
            )
    _require_torque(name, table)
    return table


def _pushing(table: NDArray[np.float64]) -> list[tuple[float, float]]:
    """J and K_Q where it pushes ahead: at J = 0, at the rows above, and where K_T falls to 0, also beyond the rows."""
    found = [(0.0, at_zero_advance(table)[1])]
    found += [(J, K_Q) for J, K_T, K_Q in table.tolist() if J > 0.0 and K_T >= 0.0]
    for row, after in pairwise([*table, 2.0 * table[-1] - table[-2]]):
        last = row[0] == table[-1, 0]
        if row[1] > 0.0 and (after[1] < 0.0 or (last and after[1] < row[1])):
            J, _, K_Q = (row + row[1] / (row[1] - after[1]) * (after - row)).tolist()
            found += [(J, K_Q)] if J > 0.0 else []
    return found


def best_efficiency(table: NDArray[np.float64]) -> tuple[float, float]:
    """Largest open-water efficiency J K_T / (2 pi K_Q) where a propeller pushes, and the J of it.

    Sampled; infinite where K_Q is 0.

    Args:
        table: (n,3) J, K_T, K_Q, as `open_water_rows` returns them.
    """
    J = np.linspace(0.0, max(each for each, _ in _pushing(table)), _SAMPLES + 1)[1:]
    on = np.clip(np.searchsorted(table[:, 0], J) - 1, 0, len(table) - 2)
    share = (J - table[on, 0]) / (table[on + 1, 0] - table[on, 0])
    K_T, K_Q = (table[on, k] + share * (table[on + 1, k] - table[on, k]) for k in (1, 2))
    power = 2.0 * np.pi * np.maximum(K_Q, 0.0)
    useful = J * np.maximum(K_T, 0.0)
    with np.errstate(divide="ignore"):
        efficiency = np.divide(useful, power, out=np.zeros_like(J), where=useful > _LEAST)
    best = int(np.argmax(efficiency))
    return float(efficiency[best]), float(J[best])


def at_zero_advance(table: NDArray[np.float64]) -> tuple[float, float]:
    """K_T and K_Q at J = 0 of rows J, K_T, K_Q."""
    K_T, K_Q = (float(np.interp(0.0, table[:, 0], table[:, column])) for column in (1, 2))
    return K_T, K_Q
