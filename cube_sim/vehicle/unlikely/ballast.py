"""Bladders, tanks and their pumps whose numbers are most likely in another unit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import mujoco

from cube_sim.vehicle.mjcf.ballast import DENSITY
from cube_sim.vehicle.mjcf.parameters import WaterParameters
from cube_sim.vehicle.unlikely.bodies import DENSEST, THINNEST

LARGEST = 0.5
"""Volume that ballast takes, as a share of its vehicle's, beyond which it is worth a word (a choice)."""
SHORTEST_S = 0.1
"""Time for the whole travel of a pump below which it is (a choice)."""


def unlikely_ballast(model: mujoco.MjModel, water: WaterParameters, sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on the travel and rate of pumps, and on what a tank takes in.

    Args:
        model: made by `load_model`.
        water: as `water_of` reads it.
        sizes: as `sizes_of` returns them.
    """
    for each in water.ballast:
        pump = model.actuator(each.pump).name
        low, high = model.actuator_ctrlrange[each.pump].tolist()
        volume = sizes.get(each.hull)
        if volume is not None and max(-low, high) > LARGEST * volume:
            most = low if -low > high else high
            yield (
                f"ballast '{each.site}' takes up to {most:.3g} m^3, on a vehicle that displaces {volume:.2g} m^3; is "
                f"the ctrlrange of '{pump}' in [m^3]?"
            )
        rate = float(model.actuator_dynprm[each.pump, 1])
        if high - low < SHORTEST_S * rate:
            yield (
                f"ballast '{each.site}' is pumped by {rate:.3g} m^3/s, from end to end of its travel within "
                f"{(high - low) / rate:.2g} s; is the rate of '{pump}' in [m^3/s]?"
            )
        if each.density > 0.0 and not THINNEST <= each.density <= DENSEST:
            yield (
                f"{each.site}:{DENSITY} is {each.density:g} kg/m^3, and the water has {water.density:g}; is it in "
                "[kg/m^3]?"
            )
