"""Which thrusters of an MJCF are propellers in an inflow, and their numbers.

    <actuator>:propeller_diameter      D [m]; it makes a thruster a propeller, in place of a thruster_characteristic
    <actuator>:propeller_speed         speeds of rotation at the commands -1 and 1 [rev/s], both positive; one for both
    <actuator>:propeller_linear        a_T, b_T, a_Q, b_Q of K_T = a_T + b_T J, K_Q = a_Q + b_Q J
    <actuator>:propeller_open_water    or rows J, K_T, K_Q of a propeller that turns ahead, J increasing
    <actuator>:propeller_astern        such rows of one that turns backwards; left out, those for ahead
    <actuator>:propeller_wake          wake fraction w and thrust deduction t; left out, 0 0
    <actuator>:propeller_slowest       speeds of rotation below which it stands, backwards and ahead [rev/s];
                                       left out, 0 0
    <actuator>:propeller_hand          1 for a right-handed propeller, -1 for a left-handed one; left out, the hull gets
                                       no torque of it, as of a pair that turns against one another
    <body>:propeller_...               each of these for all thrusters of a hull, where they have none of their own

Its site is on the hull itself, z the way it pushes. Its lag is that of its speed of rotation: ``dyntype="filter"`` with
one time constant, or ``dyntype="user" dynprm="T1 T2"`` with two in a row, of the speed controller and of the rotor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.mjcf.numbers import Numerics, either, rows, scalar, vector

DIAMETER, LINEAR, OPEN_WATER = "propeller_diameter", "propeller_linear", "propeller_open_water"
PROPELLER_PARAMETERS = (
    DIAMETER,
    "propeller_speed",
    LINEAR,
    OPEN_WATER,
    "propeller_astern",
    "propeller_wake",
    "propeller_slowest",
    "propeller_hand",
)
_CURVE = "thruster_characteristic"
_SIDE_POINTS = 24
"""Points a side of the curve that stands for a propeller at rest, where one is looked at (a choice)."""


@dataclass(frozen=True)
class PropellerParameters:
    """One propeller.

    Attributes:
        site: that it pushes at.
        hull: the body that carries it.
        diameter: D [m].
        density: of the water [kg/m^3].
        wake: w.
        deduction: t.
        speeds: (2,) of rotation at the commands -1 and 1 [rev/s].
        slowest: (2,) below which it stands, backwards and ahead [rev/s].
        hand: 1, -1 or 0.
        ahead: (n,3) J, K_T, K_Q of one that turns ahead.
        astern: (k,3) of one that turns backwards.
    """

    site: str
    hull: str
    diameter: float
    density: float
    wake: float
    deduction: float
    speeds: tuple[float, float]
    slowest: tuple[float, float]
    hand: float
    ahead: NDArray[np.float64]
    astern: NDArray[np.float64]

    @property
    def arm(self) -> float:
        """Torque on the hull per newton of thrust, at rest and ahead [m]: what the gear of its actuator says."""
        K_T, K_Q = _at_rest(self.ahead)
        return -self.hand * K_Q * self.diameter / ((1.0 - self.deduction) * K_T)

    def curve(self) -> Characteristic:
        """Command to force in water that does not flow."""
        share = np.linspace(0.0, 1.0, _SIDE_POINTS + 1)
        slow = self.slowest[0] / self.speeds[0], self.slowest[1] / self.speeds[1]
        back, ahead = (start + (1.0 - start) * share for start in slow)
        commands = np.unique(np.concatenate([-back, [0.0], ahead]))
        scale = (1.0 - self.deduction) * self.density * self.diameter**4
        largest = [
            scale * _at_rest(side)[0] * n * n for side, n in zip((self.astern, self.ahead), self.speeds, strict=True)
        ]
        forces = np.where(commands < 0.0, -largest[0], largest[1]) * commands**2
        return Characteristic(commands, forces + 0.0, (-largest[0] * slow[0] ** 2 + 0.0, largest[1] * slow[1] ** 2))


def propeller_of(
    numerics: Numerics, actuator: str, body: str, site: str, site_body: str, density: float
) -> PropellerParameters | None:
    """The propeller that a thruster is; None for one that has a characteristic.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        actuator: the thruster.
        body: the hull.
        site: that it pushes at.
        site_body: the body that carries the site.
        density: of the water [kg/m^3].

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    named = {parameter: either(numerics, actuator, body, parameter) for parameter in PROPELLER_PARAMETERS}
    diameter = _diameter_of(numerics, named, actuator, body)
    if diameter is None:
        return None
    if site_body != body:
        raise ModelError(site, f"is a propeller's on '{site_body}'; the site of a propeller is on the hull itself")
    D = _positive(numerics, diameter, "a diameter [m]")
    speeds = _speeds(numerics, named["propeller_speed"], actuator)
    slowest = _slowest(numerics, named["propeller_slowest"], speeds)
    wake, deduction = _pair(numerics, named["propeller_wake"])
    if not (wake < 1.0 and deduction < 1.0):
        raise ModelError(named["propeller_wake"] or "", f"is {wake:g} {deduction:g}; w and t below 1 are right")
    hand = 0.0 if named["propeller_hand"] is None else scalar(numerics, named["propeller_hand"])
    if hand not in (-1.0, 0.0, 1.0):
        raise ModelError(
            named["propeller_hand"] or "", f"is {hand:g}; 1 (right-handed), -1 (left-handed) or 0 (no torque) is right"
        )
    ahead = _points(numerics, named, actuator)
    astern = ahead
    if (name := named["propeller_astern"]) is not None:
        astern = _table(numerics, name)
    return PropellerParameters(site, body, D, density, wake, deduction, speeds, slowest, hand, ahead, astern)


def _diameter_of(numerics: Numerics, named: Mapping[str, str | None], actuator: str, body: str) -> str | None:
    """The numeric that makes a thruster a propeller; None where it has a characteristic."""
    diameter, curve = named[DIAMETER], either(numerics, actuator, body, _CURVE)
    its_own = [name for name in (*named.values(), curve) if name is not None and name.startswith(f"{actuator}:")]
    if diameter is None:
        if its_own and its_own != [curve]:
            raise ModelError(
                f"{actuator}:{DIAMETER}", f"is missing; propeller '{actuator}' needs it [m], as {its_own[0]} does"
            )
        if curve is None and any(named.values()):
            raise ModelError(f"{body}:{DIAMETER}", f"is missing; propeller '{actuator}' needs its diameter [m]")
        return None
    if curve is None or (diameter in its_own and curve not in its_own):
        return diameter
    if curve in its_own and diameter not in its_own:
        return None  # its own curve, beside propellers
    raise ModelError(curve, f"stands beside {diameter}; a thruster has a characteristic or is a propeller, not both")


def _positive(numerics: Numerics, name: str, what: str) -> float:
    value = scalar(numerics, name)
    if value <= 0.0:
        raise ModelError(name, f"is {value:g}; {what} is positive")
    return value


def _pair(numerics: Numerics, name: str | None) -> tuple[float, float]:
    one, two = (0.0, 0.0) if name is None else vector(numerics, name, 2).tolist()
    return one, two


def _slowest(numerics: Numerics, name: str | None, speeds: tuple[float, float]) -> tuple[float, float]:
    slowest = _pair(numerics, name)
    for slow, fast, way in zip(slowest, speeds, ("backwards", "ahead"), strict=True):
        if not 0.0 <= slow < fast:
            raise ModelError(
                name or "", f"is {slow:g} rev/s {way}; from 0 to below its full speed, {fast:g} rev/s, is right"
            )
    return slowest


def _speeds(numerics: Numerics, name: str | None, actuator: str) -> tuple[float, float]:
    if name is None:
        raise ModelError(
            f"{actuator}:propeller_speed",
            f"is missing; propeller '{actuator}' needs its speeds at full command [rev/s]",
        )
    size = numerics[name].size
    values = vector(numerics, name, 2 if size != 1 else 1).tolist()
    if min(values) <= 0.0:
        raise ModelError(
            name, f"is {' '.join(f'{v:g}' for v in values)}; speeds of rotation [rev/s] at the commands -1 and 1, both "
            "above 0, are right"
        )  # fmt: skip
    return values[0], values[-1]


def _points(numerics: Numerics, named: dict[str, str | None], actuator: str) -> NDArray[np.float64]:
    linear, table = named[LINEAR], named[OPEN_WATER]
    if linear is not None and table is not None and linear.partition(":")[0] != table.partition(":")[0]:
        its_own = f"{actuator}:"
        linear, table = (linear if linear.startswith(its_own) else None), (table if table.startswith(its_own) else None)
    if linear is not None and table is not None:
        raise ModelError(linear, f"stands beside {table}; one of the two is right")
    if table is not None:
        return _table(numerics, table)
    if linear is None:
        raise ModelError(
            f"{actuator}:{OPEN_WATER}",
            f"is missing; propeller '{actuator}' needs its rows J, K_T, K_Q, or {LINEAR}: a_T b_T a_Q b_Q",
        )
    a_T, b_T, a_Q, b_Q = vector(numerics, linear, 4).tolist()
    if not (a_T > 0.0 and b_T <= 0.0):
        raise ModelError(linear, f"has K_T = {a_T:g} + {b_T:g} J; K_T above 0 at J = 0 that falls with J is right")
    if a_Q < 0.0:
        raise ModelError(linear, f"has K_Q = {a_Q:g} at J = 0; 0 or more is right")
    return np.array([[0.0, a_T, a_Q], [1.0, a_T + b_T, a_Q + b_Q]])


def _table(numerics: Numerics, name: str) -> NDArray[np.float64]:
    table = rows(numerics, name, 3, "J, K_T, K_Q")
    if len(table) < 2:
        raise ModelError(name, f"has {len(table)} rows J, K_T, K_Q; two at least are right")
    J, K_T = table[:, 0], table[:, 1]
    if np.any(np.diff(J) <= 0.0):
        i = int(np.argmax(np.diff(J) <= 0.0))
        raise ModelError(name, f"goes from J = {J[i]:g} to {J[i + 1]:g} in row {i + 2}; J increases from row to row")
    for i in range(len(table) - 1):
        b = (K_T[i + 1] - K_T[i]) / (J[i + 1] - J[i])
        if b > 0.0 and J[i + 1] > 0.0:
            raise ModelError(
                name,
                f"rises from K_T = {K_T[i]:g} to {K_T[i + 1]:g} in row {i + 2}; ahead, where J is above 0, K_T falls",
            )
        # dT/dn = rho D^4 n (2 K_T - J dK_T/dJ) where it pushes; the line before the first row goes on for ever.
        ends = [(J[i], K_T[i]), (J[i + 1], K_T[i + 1])] + (
            [(2.0 * J[0] - J[1], K_T[0] - b * (J[1] - J[0]))] if i == 0 else []
        )
        if any(k > 0.0 and 2.0 * k - j * b <= 0.0 for j, k in ends):
            raise ModelError(
                name, f"makes no more thrust with more turns about J = {J[i]:g} (row {i + 1}); it would not steer"
            )
    at_rest, torque = _at_rest(table)
    if J[0] > 0.0 or J[-1] < 0.0 or at_rest <= 0.0:
        raise ModelError(
            name, f"has K_T = {at_rest:g} at J = 0; rows from J = 0 or below, with K_T above 0 there, are right"
        )
    if torque < 0.0:
        raise ModelError(name, f"has K_Q = {torque:g} at J = 0; 0 or more is right")
    return table


def _at_rest(table: NDArray[np.float64]) -> tuple[float, float]:
    """K_T and K_Q at J = 0 of rows J, K_T, K_Q."""
    K_T, K_Q = (float(np.interp(0.0, table[:, 0], table[:, column])) for column in (1, 2))
    return K_T, K_Q
