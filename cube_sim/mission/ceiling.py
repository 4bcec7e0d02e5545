"""Where the water stops carrying the vehicle of a mission, for the controller and for what is said of it."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from cube_sim.control.ceiling import Ceiling, lift
from cube_sim.mission.hull import CompiledHull
from cube_sim.scenario import Scenario
from cube_sim.vehicle.floating import UP, Buoyancy, floating_height, water_surface, weighs_less
from cube_sim.vehicle.laws.surface import share_of_depth

if TYPE_CHECKING:
    from cube_sim.mission import Mission

LITTLE = 0.01
"""Share of its weight that is worth a word where the water does not carry it (a choice)."""
_STEPS = 60


def ceiling_of(hull: CompiledHull, scenario: Scenario) -> Ceiling | None:
    """What a hull lacks near the surface; None in endless water.

    Args:
        hull: that the controller believes in.
        scenario: whose surface counts, before that of the model.
    """
    model, vehicle = hull
    surface = water_surface(model) if scenario.surface_m is None else scenario.surface_m
    if surface == inf:
        return None
    floats = Buoyancy.of(model, vehicle)
    halves, centres = floats.extents(UP)
    awash, dry = surface - float((centres + halves).max()), surface - float((centres - halves).min())
    heights = np.linspace(awash, dry, _STEPS + 1)
    missing = np.array([floats.weight - floats.carried(surface - each, UP) for each in heights.tolist()])
    return Ceiling(heights, missing, _wet(model, hull, surface - heights))


def ceiling_words(mission: Mission) -> str:
    """What the surface does to a hull whose path lies above where the water carries it; "" for any other."""
    hull, ability = CompiledHull(mission.model, mission.vehicle), mission.ability.within_limit
    ceiling, asked = ceiling_of(hull, mission.scenario), float(mission.outline[:, 2].max())
    if ceiling is None:
        return ""
    budget = ability.budget
    up = 0.0 if budget is None else lift(budget.normals, budget.bounds, budget.held_shares, 1.0)
    missing, wet = ceiling.at(asked)
    if missing <= LITTLE * ceiling.missing[-1]:
        return ""
    below = f"with its origin {-floating_height(*hull):.2f} m below it"
    floats = f"{'floats' if weighs_less(mission.vehicle) else 'is awash'} {below}"
    said = (
        f"left to itself the hull {floats}, and at z = {asked:.2f} m {missing:.3g} N of its weight are not carried, "
        f"of which its thrusters lift {min(missing, up * wet):.3g} N"
    )
    highest = getattr(mission.controller, "highest", inf)
    return said if asked <= highest else f"{said}: it is asked no higher than z = {highest:.2f} m"


def _wet(model: mujoco.MjModel, hull: CompiledHull, depths: np.ndarray) -> np.ndarray:
    """Share of their vertical force that thrusters make, with the upright hull's origin at depths (n,) [m]."""
    vehicle = hull.vehicle
    vertical = np.abs(vehicle.actuation_matrix[2])
    if not vertical.any():
        return np.ones(len(depths))
    data = mujoco.MjData(model)
    at = vehicle.qpos_address
    data.qpos[at : at + 7] = 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    mujoco.mj_kinematics(model, data)
    sites = model.actuator_trnid[vehicle.thrusters.actuators, 0]
    places, radii = data.site_xpos[sites, 2].tolist(), model.site_size[sites, 0].tolist()
    shares = [
        [
            1.0 if depth - z >= radius else share_of_depth(depth - z, radius)
            for z, radius in zip(places, radii, strict=True)
        ]
        for depth in depths.tolist()
    ]
    return np.array(shares) @ vertical / vertical.sum()
