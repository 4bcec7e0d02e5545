"""What is worth a word about a vehicle's own numbers: weight against buoyancy, its attitude at rest, stiff drag."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.spatial import Vector
from cube_sim.vehicle.feeding import feeding_words
from cube_sim.vehicle.fins import Fins, lift_tables
from cube_sim.vehicle.floating import floating_height
from cube_sim.vehicle.laws import fin
from cube_sim.vehicle.mjcf.unused import kept_words
from cube_sim.vehicle.plugin import packing
from cube_sim.vehicle.stiffness import stiff_words
from cube_sim.vehicle.unlikely.words import unlikely_words
from cube_sim.vehicle.vehicle import Vehicle, hull_names

NEUTRAL = 1e-3
"""Share of its weight by which a vehicle's buoyancy may differ and still be called neutral (a choice)."""
TILTED_DEG = 3.0
"""Tilt at rest that is worth a word (a choice)."""
ASLANT_DEG = 30.0
"""Tilt at rest beyond which a hull is most likely no more as it was meant, where its thrusters cannot hold it level (a
choice)."""
UPSIDE_DOWN_DEG = 135.0
"""Tilt at rest from which on a hull lies on its back rather than on its side (a choice)."""
LEAST_ARM_M = 1e-6
"""Height of the centre of buoyancy over that of mass that rights a hull at all (a choice)."""


def remarks(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    """Sentences on a hull left to itself, and on what no analysis looks at."""
    g = float(np.linalg.norm(vehicle.gravity))
    weight, lift = vehicle.mass * g, vehicle.displaced_mass * g
    said = [_buoyancy(model, vehicle, weight, lift), *_ballast(vehicle, lift - weight)]
    if g > 0.0:
        said += _at_rest(_righting(vehicle), weight, _most(vehicle, slice(3, 5)))
    return said + stiff_words(model, vehicle) + _fins_ahead(model, vehicle) + _own_force(model, vehicle)


def cautions(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    """Sentences on what is most likely a mistake, for the log of whoever flies the vehicle."""
    less = (vehicle.displaced_mass - vehicle.mass) * float(np.linalg.norm(vehicle.gravity))
    said = kept_words(model) + unlikely_words(model, vehicle.name) + stiff_words(model, vehicle)
    if fed := feeding_words(vehicle.linear_damping, vehicle.quadratic_damping, vehicle.lift):
        said.append(fed)
    push = _most(vehicle, slice(0, 3))
    push += _most_ballast(vehicle)
    if abs(less) > max(push, NEUTRAL * vehicle.mass) and not Fins.from_model(model, _number(model, vehicle)).names:
        how = "sinks" if less < 0.0 else "rises"
        said.append(
            f"{how} with {abs(less):.3g} N, and its {_givers(vehicle)} give {push:.3g} N at most, whichever way it "
            "points"
        )
    righting, moment = _righting(vehicle), _most(vehicle, slice(3, 5))
    if _tilt_deg(righting) > ASLANT_DEG and moment < float(np.linalg.norm(righting)):
        weight = vehicle.mass * float(np.linalg.norm(vehicle.gravity))
        said += _at_rest(righting, weight, moment)
    return said


def _righting(vehicle: Vehicle) -> Vector:
    """Lift times its place less weight times its own (3,) [N m], body axes: along z where it rests upright."""
    g = float(np.linalg.norm(vehicle.gravity))
    return g * (vehicle.displaced_mass * vehicle.centre_of_buoyancy - vehicle.mass * vehicle.centre_of_mass)


def _tilt_deg(righting: Vector) -> float:
    """Tilt at rest [deg]; 0 where nothing rights it."""
    size = float(np.linalg.norm(righting))
    return float(np.degrees(np.arccos(np.clip(righting[2] / size, -1.0, 1.0)))) if size > 0.0 else 0.0


def _most(vehicle: Vehicle, rows: slice) -> float:
    """A bound of the force [N], or moment [N m], that all thrusters together give in any direction."""
    largest = np.abs(vehicle.thrusters.limits).max(axis=1, initial=0.0)
    return float(largest @ np.linalg.norm(vehicle.actuation_matrix[rows], axis=0))


def _most_ballast(vehicle: Vehicle) -> float:
    """A bound of the lift or weight that all ballast makes [N]."""
    if vehicle.ballast is None:
        return 0.0
    each = np.abs(vehicle.ballast.lift_per_volume) * np.abs(vehicle.ballast.travel).max(axis=1)
    return float(each.sum() * np.linalg.norm(vehicle.gravity))


def _givers(vehicle: Vehicle) -> str:
    return "thrusters" if vehicle.ballast is None else "thrusters and ballast"


def _buoyancy(model: mujoco.MjModel, vehicle: Vehicle, weight: float, lift: float) -> str:
    less = lift - weight
    text = f"weighs {weight:.4g} N, displaces {lift:.4g} N of water"
    if abs(less) <= NEUTRAL * weight:
        return f"{text}: neutral"
    if less < 0.0:
        return f"{text}: sinks with {-less:.3g} N"
    above = floating_height(model, vehicle)
    side = "above" if above > 0.0 else "below"
    return f"{text}: rises with {less:.3g} N; floats with its origin {abs(above):.2g} m {side} the surface"


def _ballast(vehicle: Vehicle, less: float) -> list[str]:
    """What its ballast does to a hull that is lifted by so much [N] without it."""
    ballast, g = vehicle.ballast, float(np.linalg.norm(vehicle.gravity))
    if ballast is None:
        return []
    per_litre, said = 1e-3 * g * ballast.lift_per_volume, list[str]()
    reach = np.array([0.0, 0.0])
    each = ballast.names, per_litre, 1e3 * ballast.travel, 1e3 * ballast.rate
    for name, lift, travel, rate in zip(*each, strict=True):
        ends = np.sort(lift * travel) + 0.0
        reach += ends
        text = f"its ballast '{name}' takes {travel[0]:.3g} to {travel[1]:.3g} l, {rate:.3g} l/s at most: "
        said.append(f"{text}{ends[0]:.3g} to {ends[1]:.3g} N of lift")
    if abs(less) <= NEUTRAL * vehicle.mass * g:
        return [*said, "it is neutral with its ballast at 0 l"]
    if not reach[0] <= -less <= reach[1]:
        return [*said, "no ballast it takes makes it neutral"]
    if len(per_litre) > 1:
        return [*said, "its ballast can make it neutral"]
    return [*said, f"it is neutral with its ballast at {-less / per_litre[0]:.3g} l"]


def _at_rest(righting: Vector, weight: float, moment: float) -> list[str]:
    size = float(np.linalg.norm(righting))
    if size <= LEAST_ARM_M * weight:
        return ["its centre of buoyancy lies in its centre of mass: nothing rights it"]
    tilt = _tilt_deg(righting)
    if tilt <= TILTED_DEG:
        return []
    if tilt > UPSIDE_DOWN_DEG:
        return ["its centre of mass lies above its centre of buoyancy: left to itself it turns over"]
    across = float(np.linalg.norm(righting[:2]))
    there = f", and its thrusters give {moment:.3g} N m at most" if moment < across else ""
    return [f"left to itself it rests tilted by {tilt:.0f} deg; level it has to be held with {across:.3g} N m{there}"]


def _fins_ahead(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    table = lift_tables(packing.packed_parameters(model))[2]
    places = table[table[:, fin.HULL] == _number(model, vehicle), fin.PLACE]
    if not len(places) or places.min() <= vehicle.centre_of_mass[0]:
        return []
    return ["all its fins lie ahead of its centre of mass, where they turn it out of the flow; astern they steady it"]


def _own_force(model: mujoco.MjModel, vehicle: Vehicle) -> list[str]:
    if packing.force_records(packing.packed_parameters(model))[_number(model, vehicle)].place < 0:
        return []
    return [f"{vehicle.name}:force is not looked at here: it acts in flight, and no controller knows it"]


def _number(model: mujoco.MjModel, vehicle: Vehicle) -> int:
    """Of the hull among those of the model."""
    return hull_names(model).index(vehicle.name)
