"""Which sites of an MJCF are fins, and what turns them.

    <site>:fin_area           S [m^2], of both fins of a pair that turns together; it makes the site a fin
    <site>:fin_lift_slope     a [1/rad]; left out, it follows from the aspect ratio
    <site>:fin_aspect_ratio   span^2 / area, twice that of a fin whose root the hull closes
    <site>:fin_stall          angle of stall [rad]; left out, the fin has the linear form of manoeuvring derivatives
    <site>:fin_drag           C_D0 and e of C_D = C_D0 + C_L^2 / (pi e AR); with an angle of stall
    <site>:fin_products       rows axis, j, k, n, c: F_axis += c nu_j nu_k delta^n besides, n 1 or 2, the rest as in
                              `velocity_products`: derivatives of a table by the deflection delta that no lift has
    <body>:fin_...            each of these but area and products for all fins of a hull that have none of their own

A fin's site is on the hull itself, where the lift acts: x ahead along the chord, y along the span, z along the normal.
A servo is an actuator at that site, ``dyntype="user" dynprm="lag rate"`` [s, rad/s], its `ctrlrange` the fin's travel
[rad]: its activation is the deflection, positive with the leading edge turned towards z. A fin without one is fixed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import inf, pi, sqrt

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.mjcf.body_lift import product_of
from cube_sim.vehicle.mjcf.numbers import Numerics, either, rows, scalar, vector
from cube_sim.vehicle.mjcf.thruster_elements import require_ctrlrange_alone

AREA, PRODUCTS = "fin_area", "fin_products"
_SHAPE = ("fin_lift_slope", "fin_aspect_ratio", "fin_stall", "fin_drag")
FIN_PARAMETERS = (AREA, *_SHAPE, PRODUCTS)


@dataclass(frozen=True)
class FinParameters:
    """One fin.

    Attributes:
        site: its name.
        hull: the body that carries it.
        area: S [m^2].
        lift_slope: a [1/rad].
        stall: angle of stall [rad]; infinite for the linear form.
        drag: C_D0.
        induced: 1 / (pi e AR).
        servo: index of the actuator that turns it; None for a fixed fin.
        products: (n,6) axis, j, k (0 to 5), whether |nu_k| is meant, c, and the power of the deflection.
    """

    site: str
    hull: str
    area: float
    lift_slope: float
    stall: float
    drag: float
    induced: float
    servo: int | None
    products: NDArray[np.float64]


def read_fins(
    numerics: Numerics, sites: Mapping[str, str], hulls: Sequence[str], servos: Mapping[str, int]
) -> tuple[FinParameters, ...]:
    """The fins of a model, in the order of its sites.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        sites: name -> the body that carries it, for every named site.
        hulls: names of the hulls.
        servos: site -> index of the actuator that may turn a fin there.

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    for name in numerics:
        owner, _, parameter = name.rpartition(":")
        if parameter in (AREA, PRODUCTS) and owner not in sites:
            raise ModelError(name, f"no site '{owner}'; the model has {among(owner, sites)}")
        if parameter in FIN_PARAMETERS and owner in sites and f"{owner}:{AREA}" not in numerics:
            raise ModelError(f"{owner}:{AREA}", f"is missing; fin '{owner}' needs its area [m^2]")
    return tuple(
        _fin(numerics, site, body, hulls, servos.get(site))
        for site, body in sites.items()
        if f"{site}:{AREA}" in numerics
    )


def servo_elements(spec: mujoco.MjSpec, fins: Sequence[str], others: Collection[int] = ()) -> dict[str, int]:
    """Fin site -> index of the actuator that turns it.

    Args:
        spec: of the model.
        fins: sites with an area of a fin.
        others: indices of the actuators that pump ballast.

    Raises:
        ModelError: an actuator at a fin's site that is no servo, one that MuJoCo would not run as its numbers say, or a
            servo without a fin.
    """
    found: dict[str, int] = {}
    for index, actuator in enumerate(spec.actuators):
        if actuator.trntype != mujoco.mjtTrn.mjTRN_SITE:
            continue
        name = actuator.name or f"actuator {index}"
        _require_site(spec, actuator, name)
        if index in others:
            if actuator.target in fins:
                raise ModelError(actuator.target, "is a fin and ballast; one of the two is right")
            continue
        if actuator.target not in fins:
            _require_no_servo(actuator, name)
            continue
        if actuator.target in found:
            raise ModelError(name, f"turns fin '{actuator.target}', which another actuator turns already")
        _require_servo(spec, actuator, name)
        found[actuator.target] = index
    return found


def _require_site(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator, name: str) -> None:
    if spec.site(actuator.target) is None:
        there = [site.name for site in spec.sites if site.name]
        near = get_close_matches(actuator.target, there, n=1)
        told = f"; did you mean '{near[0]}'?" if near else f"; the model has {among(actuator.target, there)}"
        raise ModelError(name, f"no site '{actuator.target}'{told}")


def _require_no_servo(actuator: mujoco.MjsActuator, name: str) -> None:
    """Refuse what nothing would move: of actuators of its kind, fins are turned and thrusters have a bias of theirs."""
    if actuator.dyntype == mujoco.mjtDyn.mjDYN_USER and actuator.biastype == mujoco.mjtBias.mjBIAS_NONE:
        raise ModelError(
            name,
            f"has dyntype=\"user\" and turns no fin: site '{actuator.target}' has no area; give "
            f"{actuator.target}:{AREA} [m^2], {actuator.target}:ballast_displaces to a pump of ballast, or "
            'biastype="user" to a thruster',
        )


def _require_servo(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator, name: str) -> None:
    fixed = actuator.gaintype == mujoco.mjtGain.mjGAIN_FIXED and actuator.gainprm[0] == 0.0
    pushes = not fixed or actuator.biastype != mujoco.mjtBias.mjBIAS_NONE
    if actuator.dyntype != mujoco.mjtDyn.mjDYN_USER or pushes:
        raise ModelError(
            name,
            f'is at fin \'{actuator.target}\' and no servo; dyntype="user" dynprm="lag rate" gaintype="fixed" '
            'gainprm="0" biastype="none" is right: the water pushes the fin, the actuator turns it',
        )
    lag_s, rate = float(actuator.dynprm[0]), float(actuator.dynprm[1])
    if not (0.0 < lag_s < inf and 0.0 < rate < inf):
        raise ModelError(
            name, f"has dynprm {lag_s:g} {rate:g}; its lag [s] and its rate [rad/s] are positive and finite"
        )
    low, high = (float(end) for end in actuator.ctrlrange)
    automatic = actuator.ctrllimited == mujoco.mjtLimited.mjLIMITED_AUTO and spec.compiler.autolimits
    limited = actuator.ctrllimited == mujoco.mjtLimited.mjLIMITED_TRUE or automatic
    if not limited or not -pi <= low <= 0.0 <= high <= pi or low == high:
        raise ModelError(name, f"has the ctrlrange {low:g} {high:g}; the fin's travel about 0 [rad] is right")
    if actuator.delay:
        raise ModelError(name, "has a delay, which a servo of a fin has not; its lag is the first value of dynprm")
    require_ctrlrange_alone(spec, actuator, name, "the deflection")
    actuator.actdim = 1


def _fin(numerics: Numerics, site: str, body: str, hulls: Sequence[str], servo: int | None) -> FinParameters:
    if body not in hulls:
        raise ModelError(site, f"is a fin on '{body}', which is no hull; a fin's site is on the hull itself")
    area = _positive(numerics, f"{site}:{AREA}", "an area [m^2]")
    slope, ratio, stall, drag = (either(numerics, site, body, parameter) for parameter in _SHAPE)
    products = _products(numerics, f"{site}:{PRODUCTS}")
    aspect = _positive(numerics, ratio, "an aspect ratio") if ratio else None
    if slope is None and aspect is None:
        raise ModelError(f"{site}:fin_lift_slope", f"is missing; fin '{site}' needs it, or 'fin_aspect_ratio'")
    lift_slope = _positive(numerics, slope, "a lift slope [1/rad]") if slope else helmbold(aspect or inf)
    if stall is None:
        if drag is not None:
            raise ModelError(drag, "belongs to a fin that stalls; give 'fin_stall' too (the linear form has no drag)")
        return FinParameters(site, body, area, lift_slope, inf, 0.0, 0.0, servo, products)
    angle = _positive(numerics, stall, "an angle of stall [rad]")
    if angle > 0.5 * pi:
        raise ModelError(stall, f"is {angle:g}; an angle of stall [rad] is below pi/2")
    if drag is None or aspect is None:
        missing = "fin_drag" if drag is None else "fin_aspect_ratio"
        raise ModelError(
            f"{site}:{missing}", f"is missing; fin '{site}' stalls, and needs C_D0, e and its aspect ratio"
        )
    least, efficiency = vector(numerics, drag, 2).tolist()
    if least < 0.0 or not 0.0 < efficiency <= 1.0:
        raise ModelError(drag, f"is {least:g} {efficiency:g}; C_D0 >= 0 and 0 < e <= 1 are right")
    induced = 1.0 / (pi * efficiency * aspect)
    return FinParameters(site, body, area, lift_slope, angle, least, induced, servo, products)


def _products(numerics: Numerics, name: str) -> NDArray[np.float64]:
    found = []
    for axis, first, second, power, coefficient in rows(numerics, name, 5, "axis, j, k, n, coefficient").tolist():
        if power not in (1.0, 2.0):
            raise ModelError(name, f"has a row with n = {power:g}; 1, the deflection, or 2, its square, is right")
        found.append([*product_of(name, axis, first, second), coefficient, power])
    return np.array(found, dtype=float).reshape(-1, 6)


def helmbold(aspect_ratio: float) -> float:
    """Lift slope of a straight wing [1/rad] by its aspect ratio, small ones too (H. B. Helmbold 1942)."""
    if aspect_ratio == inf:
        return 2.0 * pi
    return 2.0 * pi * aspect_ratio / (2.0 + sqrt(aspect_ratio**2 + 4.0))


def _positive(numerics: Numerics, name: str, what: str) -> float:
    value = scalar(numerics, name)
    if value <= 0.0:
        raise ModelError(name, f"is {value:g}; {what} is positive")
    return value


def fin_rows(model: mujoco.MjModel, fins: Sequence[FinParameters], hulls: Sequence[str], density: float) -> np.ndarray:
    """(n, 16) the table of `cube_sim.vehicle.laws.fin`.

    Args:
        model: compiled.
        fins: as `read_fins` returns them.
        hulls: names of the hulls.
        density: of the water [kg/m^3].
    """
    table = []
    for fin in fins:
        site, axes = model.site(fin.site), np.zeros(9)
        mujoco.mju_quat2Mat(axes, site.quat)
        chord, _, normal = axes.reshape(3, 3).T
        servo = -1.0 if fin.servo is None else float(model.actuator_actadr[fin.servo])
        numbers = 0.5 * density * fin.area, fin.lift_slope, fin.stall, fin.drag, fin.induced, servo
        table.append([hulls.index(fin.hull), *site.pos, *chord, *normal, *numbers])
    return np.array(table).reshape(-1, 16)
