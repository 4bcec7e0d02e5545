"""Propellers whose numbers are most likely in another unit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

import numpy as np

from cube_sim.vehicle.mjcf.parameters import WaterParameters

LARGEST = 2.0
"""Diameter of a propeller, in V^(1/3) of its vehicle, beyond which it is worth a word (a choice)."""
FASTEST_M_S = 80.0
"""Speed of its tips beyond which it is: those of fast boats have 60 m/s, and cavitate (a choice)."""


def unlikely_propellers(water: WaterParameters, sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on the diameters and speeds of propellers.

    Args:
        water: as `water_of` reads it.
        sizes: as `sizes_of` returns them.
    """
    for thruster in water.thrusters:
        if thruster is None or (propeller := thruster.propeller) is None:
            continue
        name, diameter = propeller.site, propeller.diameter
        volume = sizes.get(propeller.hull)
        if volume is not None and diameter > LARGEST * np.cbrt(volume):
            yield (
                f"the propeller at '{name}' has a diameter of {diameter:.3g} m, on a vehicle that displaces "
                f"{volume:.2g} m^3; is it in [m]?"
            )
            continue  # so is the speed of its tips
        speed = max(propeller.speeds)
        tips = pi * diameter * speed
        if tips > FASTEST_M_S and propeller.shaft is None:
            yield (
                f"the propeller at '{name}' turns with {speed:.4g} rev/s, its tips with {tips:.3g} m/s; is the "
                "speed in [rev/s]?"
            )
        elif tips > FASTEST_M_S:
            yield (
                f"the propeller at '{name}' is turned by its motor with {speed:.4g} rev/s, its tips with {tips:.3g} "
                "m/s; is K_t in [N m/A], and thruster_voltage in [V]?"
            )
