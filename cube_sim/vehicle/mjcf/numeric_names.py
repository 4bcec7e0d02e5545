"""Which custom numerics of a model are the water's, and whose they are.

An MJCF may carry other numerics too, with colons in their names or without. They are nobody's business here. A name is
judged in three cases:

- its last part is a parameter of the water, or nearly one (`hul:aded_mass` is a slip of the pen);
- what stands before the last colon is a hull, a thruster or the water itself;
- a colon was meant (`hull_added_mass`).

What is judged and not right is refused. Otherwise the water would be without it and nobody would know.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.mjcf.ballast import BALLAST_PARAMETERS
from cube_sim.vehicle.mjcf.body_lift import CORIOLIS, CROSS_FLOW, PRODUCTS, STATIONS
from cube_sim.vehicle.mjcf.elements import ELEMENT_PARAMETERS
from cube_sim.vehicle.mjcf.fins import FIN_PARAMETERS
from cube_sim.vehicle.mjcf.propellers import PROPELLER_PARAMETERS
from cube_sim.vehicle.mjcf.voltages import TABLE

DENSITY, CURRENT, SURFACE = WATER_PARAMETERS = ("water:density", "water:current", "water:surface")
HULL_PARAMETERS = (
    "volume",
    "centre_of_buoyancy",
    "added_mass",
    "linear_damping",
    "quadratic_damping",
    PRODUCTS,
    CORIOLIS,
    STATIONS,
    CROSS_FLOW,
    "surface_half_axes",
)
LINK_PARAMETERS = (*HULL_PARAMETERS[:5], "surface_half_axes")
"""Those that a body takes which a hull carries."""
THRUSTER_PARAMETERS = (
    "thruster_characteristic",
    "thruster_dead_zone",
    "thruster_power",
    "thruster_voltage",
    "thruster_pwm",
    TABLE,
    *PROPELLER_PARAMETERS,
)

_KNOWN = HULL_PARAMETERS + THRUSTER_PARAMETERS + FIN_PARAMETERS + BALLAST_PARAMETERS
_OF_WATER = tuple(name.partition(":")[2] for name in WATER_PARAMETERS)
_NEARLY = 0.8  # share of letters in common, as difflib counts them
_NEARLY_WATER = 0.85  # of the word itself: the weather is not meant
_RATHER_A_BODY = 0.6  # of a body's name, where the parameter speaks of water
_WORDS = {"damping", "drag", "buoyancy", "buoyant", "hydrodynamics", "thruster", "dead_zone"}  # nobody else's on a body
_SEPARATORS = "._-/ "
_FUNCTION = re.compile(r"[\w.]+:\w+")  # package.module:function

Numerics = Mapping[str, NDArray[np.float64]]


def one_water(numerics: Numerics) -> dict[str, NDArray[np.float64]]:
    """The numerics, with one `water:` entry of each kind in place of those that attached vehicles bring with a prefix.

    Raises:
        ModelError: two of them differ.
    """
    merged = {name: values for name, values in numerics.items() if not name.endswith(WATER_PARAMETERS)}
    for key in WATER_PARAMETERS:
        for name in (n for n in numerics if n.endswith(key)):
            if key in merged and not np.array_equal(merged[key], numerics[name], equal_nan=True):
                raise ModelError(name, f"differs from another '{key}' of the model; there is only one water")
            merged[key] = numerics[name]
    return merged


def bodies_in_water(
    numerics: Numerics,
    bodies: Sequence[str],
    thrusters: Collection[str],
    sites: Collection[str] = (),
    others: Collection[str] = (),
) -> list[str]:
    """Names of the bodies that have parameters of a hull, in body order.

    Args:
        numerics: as `one_water` returns them.
        bodies: names of all bodies.
        thrusters: names of the actuators that are thrusters.
        sites: names of all sites, which may be fins.
        others: names of the actuators that are no thrusters.

    Raises:
        ModelError: a numeric of the water that belongs to nothing, or that holds a value that is not finite.
    """
    owners = [name.rpartition(":") for name in numerics]
    hulls = {owner for owner, colon, parameter in owners if colon and parameter in HULL_PARAMETERS}
    for name, values in numerics.items():
        if name not in WATER_PARAMETERS:
            _require_colon(name, [*bodies, *thrusters], _KNOWN)
            _require_colon(name, ["water"], _OF_WATER)
            _require_colon(name, [*sites], FIN_PARAMETERS + BALLAST_PARAMETERS)
            if ":" in name:
                _judge(name, values, bodies, thrusters, hulls, sites, others)
    return [body for body in bodies if body in hulls]


def require_mapping(parameters: object) -> None:
    """Refuse parameters that are not given by name.

    Raises:
        TypeError: with what would be right.
    """
    if not isinstance(parameters, Mapping):
        given = f"not a {type(parameters).__name__}: {parameters!r:.60}"
        raise TypeError(f'a mapping from names is right, as in {{"hull:volume": 0.03}}, {given}')
    for name in parameters:
        if not isinstance(name, str):
            raise TypeError(f'names of parameters are text, as in {{"hull:volume": 0.03}}, not {name!r:.60}')


def require_parameter(name: str) -> None:
    """Refuse a name under which no parameter of the water can stand.

    Raises:
        ModelError: with the name that was probably meant.
    """
    parameter = name.rpartition(":")[2]
    known = (*_KNOWN, *ELEMENT_PARAMETERS)
    if name.endswith(WATER_PARAMETERS):
        return
    if parameter not in known:
        raise ModelError(name, _unknown(parameter, known))
    if ":" not in name:
        raise ModelError(name, f"is nobody's; write <hull>:{name}, with the name of a hull or thruster")


def force_owner(name: str, data: str, bodies: Sequence[str]) -> str | None:
    """The hull a custom text names a force for; None for a text of another program.

    Args:
        name: of the text.
        data: its value.
        bodies: names of all bodies.

    Raises:
        ModelError: a force for a hull was probably meant.
    """
    _require_colon(name, bodies, ("force",))
    owner, colon, parameter = name.rpartition(":")
    if not colon or not get_close_matches(parameter.lower(), ["force"], n=1, cutoff=_NEARLY):
        return None
    if owner in bodies and parameter == "force":
        return owner
    if _like_one_of(owner, bodies):
        raise ModelError(name, f"is no force of a hull; write <hull>:force, with one of {among(owner, bodies)}")
    if parameter == "force" and _FUNCTION.fullmatch(data.strip()):
        raise ModelError(name, f"no hull '{owner}'; the model has {among(owner, bodies)}")
    return None


def _require_colon(name: str, owners: Sequence[str], parameters: Sequence[str]) -> None:
    """Refuse `hull_added_mass` and `hull.added_mass`, which would be nobody's."""
    for owner in owners:
        end = len(owner)
        if name[:end].lower() == owner.lower() and name[end : end + 1] in tuple(_SEPARATORS):
            for meant in get_close_matches(name[end + 1 :].lower(), parameters, n=1, cutoff=_NEARLY):
                raise ModelError(name, f"has no colon, so it is nobody's; write {owner}:{meant}")


def _like_one_of(owner: str, names: Sequence[str]) -> bool:
    return bool(get_close_matches(owner.lower(), [name.lower() for name in names], n=1, cutoff=_RATHER_A_BODY))


def _judge(
    name: str,
    values: NDArray[np.float64],
    bodies: Sequence[str],
    thrusters: Collection[str],
    hulls: Collection[str],
    sites: Collection[str],
    others: Collection[str],
) -> None:
    owner, _, parameter = name.rpartition(":")
    if owner == "water" or _of_nearly_water(owner, parameter):
        raise ModelError(name, f"is nothing that water has; there are {', '.join(WATER_PARAMETERS)}")
    if parameter not in _KNOWN:
        if owner in hulls or owner in thrusters or _meant(parameter):
            raise ModelError(name, _unknown(parameter))
        if parameter.lower() in _WORDS and _like_one_of(owner, [*bodies, *thrusters]):
            raise ModelError(name, _unknown(parameter))
        return
    if not np.all(np.isfinite(values)):
        raise ModelError(name, "holds a value that is not finite")
    if parameter in HULL_PARAMETERS and owner not in bodies:
        raise ModelError(name, f"no body '{owner}'; the model has {among(owner, bodies)}")
    if parameter in FIN_PARAMETERS:
        if owner not in sites and owner not in bodies:
            raise ModelError(name, f"no site or body '{owner}'; the model has {among(owner, [*sites, *bodies])}")
        return
    if parameter in BALLAST_PARAMETERS:
        if owner not in sites:
            raise ModelError(name, f"no site '{owner}'; the model has {among(owner, sites)}")
        return
    if owner in others and owner not in bodies and owner not in thrusters:
        raise ModelError(name, f"is of the actuator '{owner}', which is no thruster; biastype=\"user\" makes it one")
    if owner not in bodies and owner not in thrusters:
        raise ModelError(name, f"no body or thruster '{owner}'; the model has {among(owner, [*bodies, *thrusters])}")


@lru_cache(maxsize=1024)  # asked again for each of a thousand models
def _of_nearly_water(owner: str, parameter: str) -> bool:
    last = re.split(rf"[:{re.escape(_SEPARATORS)}]", owner.lower())[-1]
    water = last.endswith("water") or get_close_matches(last, ["water"], n=1, cutoff=_NEARLY_WATER)
    return bool(water and get_close_matches(parameter.lower(), _OF_WATER, n=1, cutoff=_NEARLY))


def _meant(parameter: str, known: Sequence[str] = _KNOWN) -> list[str]:
    return get_close_matches(parameter.lower(), known, n=1, cutoff=_NEARLY)


def _unknown(parameter: str, known: Sequence[str] = _KNOWN) -> str:
    meant = _meant(parameter, known)
    told = f" (did you mean {meant[0]}?)" if meant else f"; there are {among(parameter, (*known, *WATER_PARAMETERS))}"
    return f"is no parameter of the water{told}"
