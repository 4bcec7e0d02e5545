"""Propellers whose numbers are most likely in another unit, or others than those that are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

import numpy as np

from cube_sim.vehicle.mjcf.open_water import best_efficiency
from cube_sim.vehicle.mjcf.parameters import WaterParameters
from cube_sim.vehicle.mjcf.propellers import PropellerParameters

LARGEST = 2.0
"""Diameter of a propeller, in V^(1/3) of its vehicle, beyond which it is worth a word (a choice)."""
FASTEST_M_S = 80.0
"""Speed of its tips beyond which it is: those of fast boats have 60 m/s, and cavitate (a choice)."""
POOREST, BEST = 0.1, 1.0
"""Best open-water efficiencies between which one lies; those of propellers are 0.3 to 0.8 (the lower is a choice)."""
SLOWEST = 0.6
"""Wake fraction and thrust deduction beyond which they are worth a word: full ships have 0.45 and 0.3 (a choice)."""


def unlikely_propellers(water: WaterParameters, sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on the diameters and speeds of propellers, on their open-water tables and on the hull before them.

    Args:
        water: as `water_of` reads it.
        sizes: as `sizes_of` returns them.
    """
    for thruster in water.thrusters:
        if thruster is None or (propeller := thruster.propeller) is None:
            continue
        yield from _of_coefficients(propeller)
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


def _of_coefficients(propeller: PropellerParameters) -> Iterator[str]:
    for way, table in (("ahead", propeller.ahead), ("astern", propeller.astern)):
        if way == "astern" and table is propeller.ahead:
            continue
        best, J = best_efficiency(table)
        if best < POOREST:
            yield (
                f"the propeller at '{propeller.site}' turns {best:.1%} of its shaft's power into thrust at best, at J "
                f"= {J:.2g} {way}; propellers reach 30 to 80%; is it K_Q, not 10 K_Q?"
            )
        elif best > BEST:
            yield (
                f"the propeller at '{propeller.site}' turns {best:.0%} of its shaft's power into thrust at J = {J:.2g} "
                f"{way}, which none does; is each row J, K_T, K_Q, none of them times 10?"
            )
    wake, deduction = propeller.wake, propeller.deduction
    if max(wake, deduction) > SLOWEST:
        yield (
            f"the propeller at '{propeller.site}' has a wake fraction w of {wake:g} and a thrust deduction t of "
            f"{deduction:g}; hulls have 0 to 0.45; are they w and t, not 1 - w and 1 - t?"
        )
