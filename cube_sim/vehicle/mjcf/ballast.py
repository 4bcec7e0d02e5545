"""Which sites of an MJCF are variable ballast, and what pumps it.

    <site>:ballast_displaces  alpha, the share of the pumped volume by which the hull displaces more: 1 for a bladder
                              outside it, that oil is pumped into; left out, 0
    <site>:ballast_density    beta, the mass that comes in with a cubic metre [kg/m^3]: that of the water for a tank
                              that takes it in; left out, 0

One of the two makes the site ballast; both together are what both do. Its site is on the hull itself, where the volume
is; the size of the site says over which depth a bladder's lift fades at the surface. A pump is an actuator at that
site, ``dyntype="user" dynprm="lag rate"`` [s, m^3/s], its `ctrlrange` [m^3]: its activation is the volume, away from
what hull:volume and the hull's mass count. So 0 is that of a hull that these describe, a bladder may go below, and a
tank, whose hull's mass counts it empty, begins there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.mjcf.numbers import Numerics, scalar
from cube_sim.vehicle.mjcf.thruster_elements import require_ctrlrange_alone

DISPLACES, DENSITY = BALLAST_PARAMETERS = ("ballast_displaces", "ballast_density")


@dataclass(frozen=True)
class BallastParameters:
    """One bladder or tank.

    Attributes:
        site: its name.
        hull: the body that carries it.
        displaces: alpha.
        density: beta [kg/m^3].
        pump: index of the actuator that moves it.
    """

    site: str
    hull: str
    displaces: float
    density: float
    pump: int


def is_ballast(numerics: Numerics, site: str) -> bool:
    """Whether a site has a parameter of ballast."""
    return any(f"{site}:{parameter}" in numerics for parameter in BALLAST_PARAMETERS)


def read_ballast(
    numerics: Numerics, sites: Mapping[str, str], hulls: Sequence[str], pumps: Mapping[str, int]
) -> tuple[BallastParameters, ...]:
    """The ballast of a model, in the order of its sites.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        sites: name -> the body that carries it, for every named site.
        hulls: names of the hulls.
        pumps: site -> index of the actuator that pumps there.

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    for name in numerics:
        owner, _, parameter = name.rpartition(":")
        if parameter in BALLAST_PARAMETERS and owner not in sites:
            raise ModelError(name, f"no site '{owner}'; the model has {among(owner, sites)}")
    found = ((site, body) for site, body in sites.items() if is_ballast(numerics, site))
    return tuple(_ballast(numerics, site, body, hulls, pumps) for site, body in found)


def _ballast(
    numerics: Numerics, site: str, body: str, hulls: Sequence[str], pumps: Mapping[str, int]
) -> BallastParameters:
    if body not in hulls:
        raise ModelError(site, f"is ballast on '{body}', which is no hull; its site is on the hull itself")
    if site not in pumps:
        raise ModelError(site, f"is ballast that nothing pumps; {RIGHT.format(site=site)} is right")
    displaces, density = (scalar(numerics, f"{site}:{parameter}") for parameter in BALLAST_PARAMETERS)
    if not 0.0 <= displaces <= 1.0:
        raise ModelError(f"{site}:{DISPLACES}", f"is {displaces:g}; a share of the volume, 0 to 1, is right")
    if density < 0.0:
        raise ModelError(f"{site}:{DENSITY}", f"is {density:g}; the mass of a cubic metre [kg/m^3] is not negative")
    if displaces == 0.0 and density == 0.0:
        raise ModelError(
            site, f"is ballast without effect; {DISPLACES} 1 for a bladder, {DENSITY} of the water for a tank, is right"
        )
    return BallastParameters(site, body, displaces, density, pumps[site])


RIGHT = '<general site="{site}" dyntype="user" dynprm="lag rate" gainprm="0" ctrlrange="least most"/> [s, m^3/s, m^3]'


def pump_elements(spec: mujoco.MjSpec, numerics: Numerics) -> dict[str, int]:
    """Site of ballast -> index of the actuator that pumps there.

    Args:
        spec: of the model.
        numerics: name -> values (n,), all numerics of the model.

    Raises:
        ModelError: an actuator at such a site that is no pump, or one that MuJoCo would not run as its numbers say.
    """
    found: dict[str, int] = {}
    for index, actuator in enumerate(spec.actuators):
        if actuator.trntype != mujoco.mjtTrn.mjTRN_SITE or not is_ballast(numerics, actuator.target):
            continue
        name = actuator.name
        if not name:
            raise ModelError(f"actuator {index}", f"pumps the ballast '{actuator.target}' and has no name")
        if actuator.target in found:
            raise ModelError(name, f"pumps the ballast '{actuator.target}', which another actuator pumps already")
        _require_pump(spec, actuator, name, f"{actuator.target}:{DENSITY}" in numerics)
        found[actuator.target] = index
    return found


def _require_pump(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator, name: str, tank: bool) -> None:
    fixed = actuator.gaintype == mujoco.mjtGain.mjGAIN_FIXED and actuator.gainprm[0] == 0.0
    pushes = not fixed or actuator.biastype != mujoco.mjtBias.mjBIAS_NONE
    if actuator.dyntype != mujoco.mjtDyn.mjDYN_USER or pushes:
        raise ModelError(
            name, f"is at the ballast '{actuator.target}' and no pump; {RIGHT.format(site=actuator.target)} is right"
        )
    lag_s, rate = float(actuator.dynprm[0]), float(actuator.dynprm[1])
    if not (0.0 < lag_s < inf and 0.0 < rate < inf):
        raise ModelError(
            name, f"has dynprm {lag_s:g} {rate:g}; its lag [s] and its rate [m^3/s] are positive and finite"
        )
    low, high = (float(end) for end in actuator.ctrlrange)
    automatic = actuator.ctrllimited == mujoco.mjtLimited.mjLIMITED_AUTO and spec.compiler.autolimits
    limited = actuator.ctrllimited == mujoco.mjtLimited.mjLIMITED_TRUE or automatic
    if not limited or not low <= 0.0 <= high or low == high:
        raise ModelError(name, f"has the ctrlrange {low:g} {high:g}; least and most volume about 0 [m^3] is right")
    if tank and low < 0.0:
        raise ModelError(
            name, f"has the ctrlrange {low:g} {high:g}; that of a tank begins at 0: the hull's mass counts it empty"
        )
    if actuator.delay:
        raise ModelError(name, "has a delay, which a pump has not; its lag is the first value of dynprm")
    require_ctrlrange_alone(spec, actuator, name, "the volume")
    actuator.actdim = 1


def ballast_table(
    model: mujoco.MjModel, ballast: Sequence[BallastParameters], hulls: Sequence[str], water_density: float
) -> NDArray[np.float64]:
    """(n,9) the table of `cube_sim.vehicle.laws.ballast`.

    Args:
        model: compiled.
        ballast: as `read_ballast` returns it.
        hulls: names of the hulls.
        water_density: [kg/m^3].
    """
    table = []
    for each in ballast:
        site, state = model.site(each.site), float(model.actuator_actadr[each.pump])
        numbers = each.displaces * water_density, each.density, state, float(each.pump), float(site.id)
        table.append([float(hulls.index(each.hull)), *site.pos, *numbers])
    return np.array(table, dtype=float).reshape(-1, 9)
