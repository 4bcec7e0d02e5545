"""How large vehicles are, for whoever asks whether a number fits one."""

from __future__ import annotations

from cube_sim.vehicle.mjcf.parameters import WaterParameters


def sizes_of(water: WaterParameters) -> dict[str, float]:
    """Hull -> volume of it and its links [m^3]; without a hull that nothing is known of, for it displaces nothing."""
    volumes = {hull.body: hull.volume for hull in water.hulls}
    for link in water.links:
        volumes[link.hull] += link.volume
    return {hull: volume for hull, volume in volumes.items() if volume > 0.0}
