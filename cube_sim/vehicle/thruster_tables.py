"""Tables of thrust by pulse width, of several thrusters and voltages, in CSV.

    thruster,voltage_V,pulse_us,force_kgf,power_W
    T200,16,1100,-4.07,388.8

Lines that begin with # are remarks; a power that is not known is left empty. Force of more than 500 kgf is
refused, for it is one in grams. 1500 us is rest, 1100 and 1900 us are full
throttle.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from cube_sim.csv_columns import wrong_columns
from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.spatial import Matrix

COLUMNS = ("thruster", "voltage_V", "pulse_us", "force_kgf", "power_W")
REST_US, FULL_US = 1500.0, 400.0
"""Pulse width at rest, and from there to full throttle [us]."""
LARGEST_KGF = 500.0
"""About 5 kN (a choice): a table of more is in grams, or newtons."""
READING = 0.005
"""Share of its range by which a measured curve may fall from one row to the next: readings are rounded (a choice)."""

Tables = Mapping[str, Mapping[float, Matrix]]
"""Name -> voltage [V] -> rows (n,3) by command: command, force [kgf], power [W], nan where it is not known; the row at
rest is left out."""


def read_tables(file: Path) -> Tables:
    """Read a file of tables.

    Raises:
        ModelError: one line, `file:line: what is wrong`.
    """
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise ModelError(str(file), f"cannot be read: {error.strerror}") from error
    except UnicodeDecodeError:
        raise ModelError(str(file), "is not UTF-8 text") from None
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    rows = [[cell.strip() for cell in row] for row in csv.reader(line for _, line in numbered)]
    if not rows:
        raise ModelError(str(file), f"is empty; a line of {','.join(COLUMNS)} and one for each pulse are right")
    if (wrong := wrong_columns(rows[0], COLUMNS)) is not None:
        raise ModelError(f"{file}:{numbered[0][0]}", wrong)
    found: dict[str, dict[float, list[tuple[float, float, float, int]]]] = {}
    for (number, _), row in zip(numbered[1:], rows[1:], strict=True):
        name, volts, command, force, power = _row(f"{file}:{number}", row)
        if force != 0.0 or command != 0.0:
            found.setdefault(name, {}).setdefault(volts, []).append((command, force, power, number))
    tables = {name: {volts: np.array(sorted(each)) for volts, each in of.items()} for name, of in found.items()}
    for name, of in tables.items():
        for volts, table in of.items():
            pushes = table[table[:, 1] != 0.0]
            back, ahead = pushes[pushes[:, 0] < 0.0], pushes[pushes[:, 0] > 0.0]
            turned = pushes[pushes[:, 0] * pushes[:, 1] < 0.0]
            if not len(back) or not len(ahead) or len(turned):
                raise ModelError(
                    _line(file, (turned if len(turned) else pushes if len(pushes) else table)[:, 3].min()),
                    f"{name} at {volts:g} V does not push back below {REST_US:g} us and ahead above; of one that is "
                    "wired the other way round the axis is turned instead",
                )
            for side in (back, ahead):
                if len(side) == 1 and abs(side[0, 0]) != 1.0:
                    raise ModelError(
                        _line(file, side[0, 3]),
                        f"{name} at {volts:g} V has one row a side, at {REST_US + FULL_US * side[0, 0]:g} us; full "
                        "throttle is right where there is one only",
                    )
                _require_rising(file, f"{name} at {volts:g} V", side, READING * np.ptp(pushes[:, 1]))
    if not tables:
        raise ModelError(str(file), "has no row with a force")
    return {name: {volts: table[:, :3].copy() for volts, table in of.items()} for name, of in tables.items()}


def _line(file: Path, number: float) -> str:
    return f"{file}:{number:.0f}"


def _require_rising(file: Path, what: str, side: Matrix, allowed: float) -> None:
    falls = np.diff(side[:, 1])
    if falls.min(initial=0.0) < -allowed:
        i = int(np.argmin(falls))
        (one, two), (high, low) = REST_US + FULL_US * side[i : i + 2, 0], side[i : i + 2, 1]
        raise ModelError(
            _line(file, side[i + 1, 3]),
            f"{what} falls from {high:g} kgf at {one:g} us to {low:g} kgf at {two:g} us; force rises with the pulse, "
            "from full reverse (below 0) to full ahead",
        )


def _row(where: str, row: list[str]) -> tuple[str, float, float, float, float]:
    if len(row) != len(COLUMNS):
        raise ModelError(where, f"has {counted(len(row), 'value')}; {len(COLUMNS)} are right")
    try:
        volts, pulse, force = (float(cell or "0") for cell in row[1:4])
        power = float(row[4]) if row[4] else np.nan
    except ValueError:
        raise ModelError(where, f"'{','.join(row[1:])}' are not four numbers") from None
    command = (pulse - REST_US) / FULL_US
    if not row[0] or not 0.0 < volts < 1e6 or not abs(command) <= 1.0 or not abs(force) < np.inf:
        raise ModelError(
            where, f"a name, a voltage above 0, a pulse of {REST_US - FULL_US:g} to {REST_US + FULL_US:g} us are right"
        )
    if abs(force) > LARGEST_KGF:
        raise ModelError(
            where, f"{force:g} kgf is more than a thruster makes ({LARGEST_KGF:g}); kilograms-force are right"
        )
    if row[4] and not 0.0 <= power < 1e9:
        raise ModelError(where, f"a power of {power:g} W; 0 or more is right")
    return row[0].upper(), volts, command, force, power
