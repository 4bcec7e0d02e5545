"""A vehicle whose thrusters have the published tables of a T200 at several voltages, in place of one curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import cube_sim
from cube_sim.vehicle.known_thrusters import NEWTONS_IN_KGF, known_thruster, published
from support.water_bodies import Body, values

PUBLISHED = (10.0, 12.0, 16.0, 18.0, 20.0)


def rows(voltages: Sequence[float] = PUBLISHED) -> np.ndarray:
    """Voltage, command, force [N] of every published row that pushes."""
    tables = published()["T200"]
    each = [(volts, command, NEWTONS_IN_KGF * force) for volts in voltages for command, force, _ in tables[volts]]
    return np.array([row for row in each if row[2] != 0.0])


def powers(voltages: Sequence[float] = PUBLISHED) -> np.ndarray:
    """k_P-, k_P+ of each [W/N^1.5]."""
    return np.array([known_thruster("T200", volts).power for volts in voltages])


def numerics(voltages: Sequence[float] = PUBLISHED, nominal: float = 16.0, owner: str = "hull") -> str:
    given = {"voltage_table": rows(voltages), "power": powers(voltages), "voltage": [nominal]}
    return "".join(f'<numeric name="{owner}:thruster_{key}" data="{values(x)}"/>' for key, x in given.items())


def pair(voltages: Sequence[float] = PUBLISHED, nominal: float = 16.0, **parameters):
    """A model of a hull with two thrusters by such tables."""
    sites = "".join(f'<site name="{name}" pos="0 {y} 0" zaxis="1 0 0"/>' for name, y in (("a", 0.1), ("b", -0.1)))
    actuators = "".join(
        f'<general name="{name}" site="{name}" gear="0 0 1 0 0 0" dyntype="filter" dynprm="0.02" gainprm="0" '
        'biastype="user"/>'
        for name in "ab"
    )
    extra = f"<custom>{numerics(voltages, nominal)}</custom><actuator>{actuators}</actuator>"
    return cube_sim.load_model(Body().spec(inside=sites, extra=extra), parameters)
