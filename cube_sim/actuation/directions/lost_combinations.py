"""Combinations of wrench components that stay zero, or as good as zero, and how to say so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.wrench.axes import Matrix, Vector, WrenchAxes

# Coefficients below this share of the largest are left out of the words, never out of the numbers.
_SPOKEN = 0.02
_ROUNDING = 1e-9
_SILENT = 1e-6
_ZERO = "= 0"


@dataclass(frozen=True)
class Combination:
    """One independent condition on every wrench worth producing: coefficients . F_B = 0.

    Where a threshold cut rank or cost, the thrusters can break it at a high cost: by `gain` for every newton of
    thruster force.

    Attributes:
        coefficients: (n,) of the components of F_B [1] for forces, [1/m] for torques; unit norm once torques are
            scaled to newtons.
        gain: |coefficients . A| [N/N]: 0 where the condition holds exactly.
        text: the condition in words.
        leading: (n,) the same in the scale of the words, where the first component spoken of stands alone.
        unit: of the left side in that scale.
    """

    coefficients: Vector
    gain: float
    text: str
    leading: Vector
    unit: str

    def __str__(self) -> str:
        return self.text

    def beside(self, constant: Vector) -> str:
        """The words where a constant wrench (n,) [N, N m] comes on top of all the thrusters produce."""
        value = float(self.leading @ constant)
        return self.text if abs(value) < _SILENT else self.text.replace(_ZERO, f"= {value:.3g} {self.unit}")


def combinations(null_rows: Matrix, scaled: Matrix, axes: WrenchAxes, length_m: float) -> tuple[Combination, ...]:
    """Spell out a left null space, in the sparsest rows that elimination finds.

    Args:
        null_rows: (d,n) basis of the left null space of W A up to the directions that do not count, scaled components.
        scaled: W A (n,m).
        axes: what the components are.
        length_m: the torque length of W [m].

    Returns:
        d combinations; a component that is lost outright comes first and alone.
    """
    rows = _reduced(null_rows)
    several = np.count_nonzero(_spoken(rows), axis=1) != 1
    order = np.lexsort((np.argmax(_spoken(rows), axis=1), several)) if len(rows) else []
    gains = np.linalg.norm(rows @ scaled, axis=1)
    gains[gains <= _ROUNDING * np.linalg.norm(scaled)] = 0.0
    return tuple(_combination(rows[i], float(gains[i]), axes, length_m) for i in order)


def _combination(row: Vector, gain: float, axes: WrenchAxes, length_m: float) -> Combination:
    """One row (n,) of unit norm, in scaled components, as a condition on the wrench."""
    coefficients = row * axes.scale(length_m)
    spoken = np.flatnonzero(_spoken(row))
    first = spoken[0]
    alone = len(spoken) == 1
    leading = coefficients / (coefficients[first] if alone else row[first])
    unit = "N m" if alone and first >= axes.forces else "N"
    share = gain / (coefficients[first] if alone else row[first])
    ending = f"{_ZERO}, but for {abs(share):.2g} {unit} per N of thruster force" if gain else f"{_ZERO} always"
    return Combination(coefficients, gain, f"{_words(row, axes, length_m, gain)} {ending}", leading, unit)


def _reduced(null_rows: Matrix) -> Matrix:
    """Row-reduced basis of the same space, pivots chosen over all columns, rows of unit norm."""
    rows = null_rows.copy()
    pivots: list[int] = []
    for i in range(len(rows)):
        rest = np.abs(rows[i:]).round(9)
        rest[:, pivots] = 0.0
        below, column = np.unravel_index(int(np.argmax(rest)), rest.shape)
        rows[[i, i + int(below)]] = rows[[i + int(below), i]]
        rows[i] /= rows[i, column]
        for j in range(len(rows)):
            if j != i:
                rows[j] -= rows[j, column] * rows[i]
        pivots.append(int(column))
    rows[np.abs(rows) < _ROUNDING] = 0.0
    return rows / np.linalg.norm(rows, axis=1, keepdims=True) if len(rows) else rows


def _spoken(rows: Matrix) -> np.ndarray:
    """Which components of each row are large enough for the words."""
    return np.abs(rows) >= _SPOKEN * np.max(np.abs(rows), axis=-1, keepdims=True, initial=0.0)


def _words(row: Vector, axes: WrenchAxes, length_m: float, gain: float) -> str:
    """The left side in words: "cannot push sideways: Fy", "Fx and Mz only together: Fx + 2 Mz/m"."""
    spoken = np.flatnonzero(_spoken(row))
    if len(spoken) == 1:
        ability = axes.abilities[spoken[0]]
        return f"{'too costly to' if gain else 'cannot'} {ability}: {axes.names[spoken[0]]}"
    leading = row[spoken[0]]
    terms = [_term(row[j] / leading, axes, int(j), length_m) for j in spoken]
    formula = " ".join(terms).removeprefix("+ ")
    tied = [axes.names[j] for j in spoken]
    return f"{', '.join(tied[:-1])} and {tied[-1]}{', too costly but' if gain else ' only'} together: {formula}"


def _term(scaled: float, axes: WrenchAxes, j: int, length_m: float) -> str:
    """A summand in physical units: a torque's coefficient is per metre."""
    torque = j >= axes.forces
    value = abs(scaled) / length_m if torque else abs(scaled)
    number = "" if abs(value - 1.0) < 5e-4 else f"{value:.3g} "
    unit = "/m" if torque else ""
    return f"{'-' if scaled < 0.0 else '+'} {number}{axes.names[j]}{unit}"
