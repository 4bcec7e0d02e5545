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

    <actuator>:propeller_motor         K_t [N m/A, V s/rad], R [ohm]: its speed follows from the torques on its shaft,
                                       its command is the share of thruster_voltage; propeller_speed is left out
    <actuator>:propeller_efficiency    share of the electrical power that arrives at the shaft; left out, nobody knows
                                       what it draws. With a motor it follows from that
    <actuator>:propeller_shaft         I [kg m^2] of all that turns, dry friction Q_0 [N m] and viscous b [N m s];
                                       with a motor

Its site is on the hull itself, z the way it pushes. Its lag is that of its speed of rotation: ``dyntype="filter"`` with
one time constant, or ``dyntype="user" dynprm="T1 T2"`` with two in a row, of the speed controller and of the rotor.
With a motor it is ``dyntype="user" dynprm="T1 T2"``, T1 the lag of the voltage. T2 is put there at loading: I over the
slope of the torques by the speed at full command, for whoever reckons with a lag.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.mjcf.numbers import Numerics, either, scalar, vector
from cube_sim.vehicle.mjcf.open_water import LINEAR, OPEN_WATER, at_zero_advance, open_water_rows, open_water_table

DRY_BELOW = 0.02
"""As in `cube_sim.vehicle.laws.propeller`."""

DIAMETER, EFFICIENCY = "propeller_diameter", "propeller_efficiency"
PROPELLER_PARAMETERS = (
    DIAMETER,
    "propeller_speed",
    LINEAR,
    OPEN_WATER,
    "propeller_astern",
    "propeller_wake",
    "propeller_slowest",
    "propeller_hand",
    "propeller_motor",
    "propeller_shaft",
    EFFICIENCY,
)
_CURVE = "thruster_characteristic"
_SIDE_POINTS = 24
"""Points a side of the curve that stands for a propeller at rest, where one is looked at (a choice)."""


@dataclass(frozen=True)
class ShaftParameters:
    """What turns a propeller.

    Attributes:
        motor: K_t [N m/A].
        resistance: R [ohm].
        inertia: I [kg m^2].
        dry: Q_0 [N m].
        viscous: b [N m s].
        voltage: at the motor at full command [V].
    """

    motor: float
    resistance: float
    inertia: float
    dry: float
    viscous: float
    voltage: float


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
        hand: 1 or -1; 0 where nobody says it.
        ahead: (n,3) J, K_T, K_Q of one that turns ahead.
        astern: (k,3) of one that turns backwards.
        shaft: what turns it; None where its speed follows its command.
        efficiency: share of the electrical power that arrives at the shaft; 0 where nobody knows, and with a motor.
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
    shaft: ShaftParameters | None = None
    efficiency: float = 0.0

    @property
    def arm(self) -> float:
        """Torque on the hull per newton of thrust, at rest and ahead [m]: what the gear of its actuator says."""
        K_T, K_Q = at_zero_advance(self.ahead)
        return -self.hand * K_Q * self.diameter / ((1.0 - self.deduction) * K_T)

    def curve(self) -> Characteristic:
        """Command to force in water that does not flow."""
        share = np.linspace(0.0, 1.0, _SIDE_POINTS + 1)
        if self.shaft is not None:
            return self._curve_of_shaft(share)
        slow = self.slowest[0] / self.speeds[0], self.slowest[1] / self.speeds[1]
        back, ahead = (start + (1.0 - start) * share for start in slow)
        commands = np.unique(np.concatenate([-back, [0.0], ahead]))
        scale = (1.0 - self.deduction) * self.density * self.diameter**4
        largest = [
            scale * at_zero_advance(side)[0] * n * n
            for side, n in zip((self.astern, self.ahead), self.speeds, strict=True)
        ]
        forces = np.where(commands < 0.0, -largest[0], largest[1]) * commands**2
        return Characteristic(commands, forces + 0.0, (-largest[0] * slow[0] ** 2 + 0.0, largest[1] * slow[1] ** 2))

    def _curve_of_shaft(self, share: NDArray[np.float64]) -> Characteristic:
        """The curve by speeds that are shares of those at full command."""
        scale = (1.0 - self.deduction) * self.density * self.diameter**4
        commands, forces = [], []
        assert self.shaft is not None
        for side, most, sign in ((self.astern, self.speeds[0], -1.0), (self.ahead, self.speeds[1], 1.0)):
            n = most * share
            K_T, _ = at_zero_advance(side)
            volts = volts_at_rest(self.shaft, self.density * self.diameter**5, side, n)
            commands.append(sign * volts / self.shaft.voltage)
            forces.append(sign * scale * K_T * n * n)
        both = np.concatenate([commands[0][:0:-1], commands[1]]), np.concatenate([forces[0][:0:-1], forces[1]])
        both[0][[0, -1]] = -1.0, 1.0
        return Characteristic(both[0], both[1] + 0.0, (0.0, 0.0))


def volts_at_rest(
    shaft: ShaftParameters, rho_D5: float, side: NDArray[np.float64], n: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Voltages [V] that hold speeds n (k,) [rev/s], not negative, in water that does not flow.

    Args:
        shaft: what turns the propeller.
        rho_D5: rho D^5 [kg m^2].
        side: (j,3) its rows J, K_T, K_Q.
        n: [rev/s].
    """
    w = 2.0 * np.pi * n
    dry = np.clip(w / (DRY_BELOW * shaft.voltage / shaft.motor), 0.0, 1.0)
    load = rho_D5 * at_zero_advance(side)[1] * n * n + shaft.viscous * w + shaft.dry * dry
    return shaft.motor * w + shaft.resistance / shaft.motor * load


def propeller_of(
    numerics: Numerics, actuator: str, body: str, site: str, site_body: str, density: float, voltage: float | None
) -> PropellerParameters | None:
    """The propeller that a thruster is; None for one that has a characteristic.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        actuator: the thruster.
        body: the hull.
        site: that it pushes at.
        site_body: the body that carries the site.
        density: of the water [kg/m^3].
        voltage: that feeds it [V]; None where nobody says it.

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
    shaft = _shaft(numerics, named, actuator, voltage)
    speeds = (1.0, 1.0) if shaft else _speeds(numerics, named["propeller_speed"], actuator)
    slowest = _slowest(numerics, named["propeller_slowest"], speeds)
    wake, deduction = _pair(numerics, named["propeller_wake"])
    if not (wake < 1.0 and deduction < 1.0):
        raise ModelError(named["propeller_wake"] or "", f"is {wake:g} {deduction:g}; w and t below 1 are right")
    hand = 0.0 if named["propeller_hand"] is None else scalar(numerics, named["propeller_hand"])
    if (name := named["propeller_hand"]) is not None and hand not in (-1.0, 1.0):
        right = "1 (right-handed) or -1 (left-handed) is right; left out, the hull gets no torque of it"
        raise ModelError(name, f"is {hand:g}; {right}")
    ahead = open_water_rows(numerics, named[LINEAR], named[OPEN_WATER], actuator)
    astern = ahead
    if (name := named["propeller_astern"]) is not None:
        astern = open_water_table(
            numerics, name, "of a propeller that turns backwards, with the signs of one that turns ahead, "
        )
    if shaft is not None:
        speeds = _full_speed(shaft, density * D**5, astern), _full_speed(shaft, density * D**5, ahead)
    tables, efficiency = (ahead, astern), _efficiency(numerics, named, actuator)
    return PropellerParameters(
        site, body, D, density, wake, deduction, speeds, slowest, hand, *tables, shaft, efficiency
    )


def _efficiency(numerics: Numerics, named: Mapping[str, str | None], actuator: str) -> float:
    """Share of the electrical power that arrives at the shaft; 0 where nobody says it."""
    own_power, efficiency, motor = f"{actuator}:thruster_power", named[EFFICIENCY], named["propeller_motor"]
    if own_power in numerics and (beside := motor or efficiency) is not None:
        raise ModelError(own_power, f"stands beside {beside}, which says what it draws; one of the two is right")
    if efficiency is None:
        return 0.0
    if motor is not None:
        raise ModelError(efficiency, f"stands beside {motor}; what a motor loses follows from its K_t and R")
    share = scalar(numerics, efficiency)
    if not 0.0 < share <= 1.0:
        raise ModelError(efficiency, f"is {share:g}; above 0 and at most 1 is right, for example 0.7")
    return share


def _shaft(
    numerics: Numerics, named: Mapping[str, str | None], actuator: str, voltage: float | None
) -> ShaftParameters | None:
    motor, shaft = named["propeller_motor"], named["propeller_shaft"]
    if motor is None or shaft is None:
        if motor is not None or shaft is not None:
            missing = "propeller_shaft" if shaft is None else "propeller_motor"
            raise ModelError(f"{actuator}:{missing}", f"is missing; {motor or shaft} stands alone, both go together")
        return None
    for key in ("propeller_speed", "propeller_slowest"):
        if (name := named[key]) is not None:
            raise ModelError(name, f"stands beside {motor}; with a motor the speed follows from the torques")
    K_t, R = vector(numerics, motor, 2).tolist()
    if not (K_t > 0.0 and R > 0.0):
        raise ModelError(motor, f"is {K_t:g} {R:g}; K_t [N m/A] and R [ohm] are positive")
    inertia, dry, viscous = vector(numerics, shaft, 3).tolist()
    if not (inertia > 0.0 and dry >= 0.0 and viscous >= 0.0):
        right = "I [kg m^2] above 0, Q_0 [N m] and b [N m s] not below, is right"
        raise ModelError(shaft, f"is {inertia:g} {dry:g} {viscous:g}; {right}")
    if voltage is None:
        text = f"is missing; '{actuator}' has a motor, whose full command it is"
        raise ModelError(f"{actuator}:thruster_voltage", text)
    if dry * R / K_t >= voltage:
        raise ModelError(shaft, f"has dry friction of {dry:g} N m, and {voltage:g} V give {K_t * voltage / R:g} N m")
    return ShaftParameters(K_t, R, inertia, dry, viscous, voltage)


def _full_speed(shaft: ShaftParameters, rho_D5: float, side: NDArray[np.float64]) -> float:
    """Speed [rev/s] at full voltage in water that does not flow."""
    low, high = 0.0, shaft.voltage / (2.0 * np.pi * shaft.motor)
    for _ in range(100):
        middle = 0.5 * (low + high)
        if float(volts_at_rest(shaft, rho_D5, side, np.array([middle]))[0]) < shaft.voltage:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def shaft_lag_s(propeller: PropellerParameters) -> float:
    """I over the slope of the torques by the speed, at full command ahead in water that does not flow [s]."""
    shaft = propeller.shaft
    assert shaft is not None
    K_Q, n = at_zero_advance(propeller.ahead)[1], propeller.speeds[1]
    by_water = propeller.density * propeller.diameter**5 * 2.0 * K_Q * n / (2.0 * np.pi)
    return shaft.inertia / (shaft.motor**2 / shaft.resistance + shaft.viscous + by_water)


def fastest_change_s(propeller: PropellerParameters) -> float:
    """The shortest time in which its shaft settles [s]: at rest, where dry friction is steepest, or at full command."""
    shaft = propeller.shaft
    assert shaft is not None
    dry = shaft.dry / (DRY_BELOW * shaft.voltage / shaft.motor)
    at_rest = shaft.inertia / (shaft.motor**2 / shaft.resistance + shaft.viscous + dry)
    return min(at_rest, shaft_lag_s(propeller))


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
