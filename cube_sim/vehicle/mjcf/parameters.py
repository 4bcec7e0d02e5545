"""The water's numbers as the MJCF states them: custom numerics named after the element they describe.

    water:density                       [kg/m^3]
    water:surface                       height z of its surface, world axes [m]; left out: endless water
    <body>:volume                       displaced volume [m^3]
    <body>:centre_of_buoyancy           [m], body axes
    <body>:added_mass                   6 (diagonal) or 36 values, symmetric positive semidefinite [kg, kg m, kg m^2]
    <body>:linear_damping               6 or 36 values [N s/m, N s, N m s]
    <body>:quadratic_damping            6 or 36 values [N s^2/m^2, N s^2/m, N m s^2]
    <body>:surface_half_axes            of the ellipsoid, about the centre of buoyancy, over which the volume is spread
                                        where the hull comes out of the water [m]; left out: the proportions of its
                                        geoms and its volume
    <body>:thruster_characteristic      pairs command, force [N] for every thruster of the hull
    <body>:thruster_dead_zone           F_DZ-, F_DZ+ [N]
    <body>:thruster_power               k_P-, k_P+ of the electrical power k_P |F|^1.5 [W/N^1.5]; may be left out
    <body>:thruster_voltage             the voltage of the characteristic [V]; may be left out
    <body>:thruster_pwm                 pulse widths of the commands -1, 0 and 1 [us]; may be left out
    <actuator>:thruster_...             each of these for one thruster, before its hull's
    <body>:thruster_voltage_table       curves at several voltages, see `cube_sim.vehicle.mjcf.voltages`
    <actuator>:propeller_...            a thruster in its inflow in place of a characteristic, see
                                        `cube_sim.vehicle.mjcf.propellers`
    <body>:velocity_products ...        lift and cross-flow drag, see `cube_sim.vehicle.mjcf.body_lift`
    <site>:fin_...                      fins, see `cube_sim.vehicle.mjcf.fins`
    <site>:ballast_...                  variable ballast, see `cube_sim.vehicle.mjcf.ballast`
    water:current                       rows time [s], height z [m], v_x, v_y, v_z [m/s] (world axes) on a full grid of
                                        times and heights, added to `option wind`; linear between, constant beyond

A free body of the world with any of the first group is a hull, and a body that it carries with any of
`LINK_PARAMETERS` is a link with water of its own, in its own axes. Each needs its volume. What else it leaves out is
zero. Vehicles attached with a prefix (``MjSpec.attach``) bring theirs with the same prefix, also their `water:`
entries: these must agree. Other numerics of the MJCF are left alone (`cube_sim.vehicle.mjcf.numeric_names`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.mjcf.ballast import BallastParameters, read_ballast
from cube_sim.vehicle.mjcf.body_lift import strips, velocity_products
from cube_sim.vehicle.mjcf.fins import FinParameters, read_fins
from cube_sim.vehicle.mjcf.numbers import either as _either
from cube_sim.vehicle.mjcf.numbers import scalar as _scalar
from cube_sim.vehicle.mjcf.numbers import vector as _vector
from cube_sim.vehicle.mjcf.numeric_names import (
    CURRENT,
    DENSITY,
    HULL_PARAMETERS,
    LINK_PARAMETERS,
    SURFACE,
    THRUSTER_PARAMETERS,
    bodies_in_water,
    one_water,
)
from cube_sim.vehicle.mjcf.propellers import DIAMETER, PropellerParameters, propeller_of
from cube_sim.vehicle.mjcf.thruster_elements import ThrusterElement
from cube_sim.vehicle.mjcf.voltages import TABLE, VoltageParameters, voltages_of
from cube_sim.vehicle.mjcf.water_body import WaterBody, water_body
from cube_sim.vehicle.thruster_tables import READING


@dataclass(frozen=True)
class HullParameters(WaterBody):
    """One hull, a free body of the world.

    Attributes:
        products: (n,5) axis, j, k, whether |nu_k| is meant, and c of each product of two velocities.
        strips: (n,3) x [m], and rho/2 C_D A [kg/m] across y and across z of each strip.
    """

    products: NDArray[np.float64]
    strips: NDArray[np.float64]


@dataclass(frozen=True)
class LinkParameters(WaterBody):
    """One link: a body that a hull carries, with water of its own.

    Attributes:
        hull: name of the hull.
    """

    hull: str


@dataclass(frozen=True)
class ThrusterParameters:
    """One thruster.

    Attributes:
        characteristic: command to steady force.
        power: (k_P-, k_P+) of the electrical power k_P |F|^1.5 [W/N^1.5]; 0 when not known.
        voltage: at which the characteristic holds [V]; None when not known.
        pulse_us: (3,) pulse widths of the commands -1, 0 and 1 [us]; None when not known.
        voltages: its curves at several voltages, of which the characteristic is that at `voltage`; None where there is
            one alone.
        propeller: in whose inflow its force depends; None where the characteristic is all there is. With one, the
            characteristic is that of water that does not flow.
    """

    characteristic: Characteristic
    power: tuple[float, float]
    voltage: float | None
    pulse_us: tuple[float, float, float] | None
    propeller: PropellerParameters | None = None
    voltages: VoltageParameters | None = None


@dataclass(frozen=True)
class CurrentProfile:
    """A current on a grid of times and heights.

    Attributes:
        times_s: (n_t,) increasing [s].
        heights: (n_z,) z in the world, increasing [m].
        velocities: (n_t, n_z, 3) [m/s], world axes.
    """

    times_s: NDArray[np.float64]
    heights: NDArray[np.float64]
    velocities: NDArray[np.float64]


@dataclass(frozen=True)
class WaterParameters:
    """What the MJCF says of the water, validated.

    Attributes:
        hulls: all hulls, in body order.
        links: all links, in body order.
        thrusters: one entry per actuator of the model; None for one that is no thruster.
        current: None for a current that does not vary.
        fins: all fins, in the order of their sites.
        density: of the water [kg/m^3].
        surface: height of the surface, world axes [m]; inf for endless water.
        ballast: all variable ballast, in the order of its sites.
    """

    hulls: tuple[HullParameters, ...]
    links: tuple[LinkParameters, ...]
    thrusters: tuple[ThrusterParameters | None, ...]
    current: CurrentProfile | None
    fins: tuple[FinParameters, ...]
    density: float
    surface: float
    ballast: tuple[BallastParameters, ...] = ()


def read_parameters(
    numerics: Mapping[str, NDArray[np.float64]],
    bodies: Mapping[str, str | None],
    thrusters: Sequence[ThrusterElement | None],
    sites: Mapping[str, str],
    servos: Mapping[str, int],
    pumps: Mapping[str, int],
) -> WaterParameters:
    """Validate the numerics of a model.

    Args:
        numerics: name -> values (n,), all numerics of the model.
        bodies: name -> the free body of the world that it is, or that carries it; None where there is none. Every
            named body but the world is there.
        thrusters: one entry per actuator of the model; None for one that is no thruster.
        sites: name -> the body that carries it, for every named site.
        servos: site of a fin -> index of the actuator that turns it.
        pumps: site of ballast -> index of the actuator that pumps there.

    Raises:
        ModelError: names the numeric at fault and says what would be right.
    """
    numerics = one_water(numerics)
    actuators = [thruster.name for thruster in thrusters if thruster]
    names = bodies_in_water(numerics, list(bodies), actuators, sites)
    if not names:
        raise ModelError(
            "custom", f"no numeric '<body>:{HULL_PARAMETERS[0]}', so there is no hull to put into the water"
        )
    for name in names:
        if bodies[name] not in names:
            raise ModelError(name, _dry(name, bodies[name]))
    if DENSITY not in numerics:
        raise ModelError(DENSITY, "is missing; the water needs a density [kg/m^3]")
    density = _scalar(numerics, DENSITY)
    if density <= 0.0:
        raise ModelError(DENSITY, f"is {density:g}; a density [kg/m^3] is positive")
    hulls = tuple(_hull(numerics, name, density) for name in names if bodies[name] == name)
    links = tuple(
        _link(numerics, name, str(bodies[name]), density, actuators) for name in names if bodies[name] != name
    )
    described = tuple(_thruster(numerics, element, density) if element else None for element in thrusters)
    fins = read_fins(numerics, sites, [hull.body for hull in hulls], servos)
    surface = _scalar(numerics, SURFACE) if SURFACE in numerics else np.inf
    ballast = read_ballast(numerics, sites, [hull.body for hull in hulls], pumps)
    return WaterParameters(hulls, links, described, _current(numerics), fins, density, surface, ballast)


def _hull(numerics: Mapping[str, NDArray[np.float64]], body: str, density: float) -> HullParameters:
    water = water_body(numerics, body, density)
    return HullParameters(
        **vars(water),
        products=velocity_products(numerics, body, water.added_mass),
        strips=strips(numerics, body, density),
    )


def _link(
    numerics: Mapping[str, NDArray[np.float64]], body: str, hull: str, density: float, actuators: Sequence[str]
) -> LinkParameters:
    others = HULL_PARAMETERS if body in actuators else (*HULL_PARAMETERS, *THRUSTER_PARAMETERS)
    for parameter in others:
        if parameter not in LINK_PARAMETERS and f"{body}:{parameter}" in numerics:
            raise ModelError(
                f"{body}:{parameter}",
                f"is for a hull{' or a thruster' * (parameter in THRUSTER_PARAMETERS)}, and '{body}' is a link of "
                f"'{hull}'; a link takes {', '.join(LINK_PARAMETERS)}",
            )
    return LinkParameters(**vars(water_body(numerics, body, density)), hull=hull)


def _dry(body: str, carrier: str | None) -> str:
    """Why a body with water parameters cannot have them."""
    told = "has water parameters but no free joint"
    if carrier is None:
        return f"{told}; only a free body of the world, and what it carries, is in the water"
    if not carrier:
        return f"{told}, and the free body that carries it has no name; give it one, and its volume"
    return f"{told}, and '{carrier}', which carries it, has no water; give {carrier}:volume, 0 where it has none"


def _current(numerics: Mapping[str, NDArray[np.float64]]) -> CurrentProfile | None:
    if CURRENT not in numerics:
        return None
    values = numerics[CURRENT]
    if values.size == 0 or values.size % 5:
        raise ModelError(
            CURRENT,
            f"has {counted(values.size, 'value')}; it takes rows of five: time, height, v_x, v_y, v_z",
        )
    if not np.all(np.isfinite(values)):
        raise ModelError(CURRENT, "holds a value that is not finite")
    rows = values.reshape(-1, 5)
    times_s, heights = np.unique(rows[:, 0]), np.unique(rows[:, 1])
    order = np.lexsort((rows[:, 1], rows[:, 0]))
    grid = np.stack(np.meshgrid(times_s, heights, indexing="ij"), axis=-1).reshape(-1, 2)
    if rows.shape[0] != grid.shape[0] or not np.array_equal(rows[order, :2], grid):
        raise ModelError(
            CURRENT,
            f"has {rows.shape[0]} rows; one for each of its {times_s.size} times at each of its "
            f"{heights.size} heights is right",
        )
    return CurrentProfile(times_s, heights, rows[order, 2:].reshape(times_s.size, heights.size, 3))


def _thruster(
    numerics: Mapping[str, NDArray[np.float64]], element: ThrusterElement, density: float
) -> ThrusterParameters:
    actuator, body = element.name, element.body
    power_name = _either(numerics, actuator, body, "thruster_power")
    voltage = _voltage(numerics, _either(numerics, actuator, body, "thruster_voltage"))
    propeller = propeller_of(numerics, actuator, body, element.site, element.site_body, density, voltage)
    table = _voltage_table(numerics, actuator, body, propeller)
    if (propeller or table) and f"{actuator}:thruster_dead_zone" in numerics:
        instead = "propeller_slowest" if propeller else "the rows of first thrust"
        raise ModelError(f"{actuator}:thruster_dead_zone", f"is not for this thruster; {instead} says where it rests")
    if table is not None:
        known = voltages_of(numerics, table, power_name)
        if voltage is None or not known.voltages[0] <= voltage <= known.voltages[-1]:
            raise ModelError(
                f"{table.rpartition(':')[0]}:thruster_voltage",
                f"is {'missing' if voltage is None else f'{voltage:g}'}; a voltage from {known.voltages[0]:g} to "
                f"{known.voltages[-1]:g} V is right, at which '{actuator}' runs without a battery",
            )
        curve, power = known.at(voltage)
    else:
        known, power = None, _power(numerics, power_name)
        curve = _characteristic(numerics, actuator, body) if propeller is None else propeller.curve()
    return ThrusterParameters(
        characteristic=curve,
        power=power,
        voltage=voltage,
        pulse_us=_pulse_us(numerics, _either(numerics, actuator, body, "thruster_pwm")),
        propeller=propeller,
        voltages=known,
    )


def _voltage_table(
    numerics: Mapping[str, NDArray[np.float64]], actuator: str, body: str, propeller: PropellerParameters | None
) -> str | None:
    """The numeric with a thruster's curves at several voltages; None for one that has one curve, or is a propeller."""
    table, curve = (_either(numerics, actuator, body, each) for each in (TABLE, "thruster_characteristic"))
    own = f"{actuator}:{TABLE}"
    if table is None or (table != own and (propeller or curve == f"{actuator}:thruster_characteristic")):
        return None
    if propeller or (curve is not None and curve.rpartition(":")[0] == table.rpartition(":")[0]):
        beside = f"{actuator}:{DIAMETER}" if propeller else curve
        raise ModelError(table, f"stands beside {beside}; one of the two is right")
    return table


def _power(numerics: Mapping[str, NDArray[np.float64]], name: str | None) -> tuple[float, float]:
    if name is None:
        return 0.0, 0.0
    reverse, forward = _vector(numerics, name, 2).tolist()
    if reverse < 0.0 or forward < 0.0:
        raise ModelError(name, "has a negative value; a motor takes power in both directions")
    return reverse, forward


def _voltage(numerics: Mapping[str, NDArray[np.float64]], name: str | None) -> float | None:
    if name is None:
        return None
    voltage = _scalar(numerics, name)
    if voltage <= 0.0:
        raise ModelError(name, f"is {voltage:g}; the voltage of a characteristic [V] is positive")
    return voltage


def _pulse_us(numerics: Mapping[str, NDArray[np.float64]], name: str | None) -> tuple[float, float, float] | None:
    if name is None:
        return None
    reverse, rest, forward = _vector(numerics, name, 3).tolist()
    if min(reverse, rest, forward) <= 0.0 or not (reverse < rest < forward or reverse > rest > forward):
        raise ModelError(
            name,
            f"[{reverse:g}, {rest:g}, {forward:g}] us is out of order; positive pulse widths of full reverse, rest and "
            "full forward, rest between the others, are right, for example 1100 1500 1900",
        )
    return reverse, rest, forward


def _characteristic(numerics: Mapping[str, NDArray[np.float64]], actuator: str, body: str) -> Characteristic:
    curve_name = _first(numerics, actuator, body, "thruster_characteristic")
    zone_name = _first(numerics, actuator, body, "thruster_dead_zone")
    pairs = numerics[curve_name]
    if pairs.size < 4 or pairs.size % 2:
        raise ModelError(
            curve_name,
            f"has {counted(pairs.size, 'value')}; it takes pairs of command and force [N], two at least",
        )
    commands, forces = pairs[0::2].copy(), pairs[1::2].copy()
    if np.any(np.diff(commands) <= 0.0):
        raise ModelError(curve_name, "its commands do not increase from pair to pair")
    if forces[0] > 0.0 or forces[-1] < 0.0:
        raise ModelError(
            curve_name, "its forces [N] must never decrease and must run from reverse (<= 0) to forward (>= 0)"
        )
    forces = _never_decreasing(curve_name, commands, forces)
    if not np.any(forces == 0.0):
        raise ModelError(curve_name, "no pair has force 0, so there is no command at which the thruster rests")
    zone = _vector(numerics, zone_name, 2)
    if not forces[0] <= zone[0] <= 0.0 <= zone[1] <= forces[-1]:
        raise ModelError(
            zone_name,
            f"[{zone[0]:g}, {zone[1]:g}] N is out of order; "
            f"{forces[0]:g} <= F_DZ- <= 0 <= F_DZ+ <= {forces[-1]:g} N is right",
        )
    curve = Characteristic(commands, forces, (float(zone[0]), float(zone[1])))
    at_rest = float(curve.force(0.0))
    if at_rest != 0.0:
        raise ModelError(
            curve_name,
            f"gives {at_rest:g} N at command 0, where the lag starts and a thruster rests; normalise its commands, "
            "pulse widths as (pulse - rest) / (full - rest), and put the widths in thruster_pwm",
        )
    return curve


def _never_decreasing(name: str, commands: NDArray[np.float64], forces: NDArray[np.float64]) -> NDArray[np.float64]:
    """The forces (n,) themselves; where they fall within rounding, neighbours at their mean (least squares).

    Published tables fall by the last digit they are read to. What falls by more is refused.
    """
    allowed = READING * (forces[-1] - forces[0])
    falls = np.diff(forces)
    if falls.min(initial=0.0) < -allowed:
        i = int(np.argmin(falls))
        raise ModelError(
            name,
            f"its forces fall from {forces[i]:g} to {forces[i + 1]:g} N at pair {i + 2} (command {commands[i + 1]:g}); "
            f"they must never decrease, but for {allowed:.2g} N of rounding ({READING:.1%} of their range)",
        )
    level: list[tuple[float, int]] = []  # mean and number of each run of equal forces
    for force in forces:
        mean, count = float(force), 1
        while level and level[-1][0] > mean:
            before, many = level.pop()
            mean, count = (before * many + mean * count) / (many + count), many + count
        level.append((mean, count))
    return np.repeat([mean for mean, _ in level], [count for _, count in level])


def _first(numerics: Mapping[str, NDArray[np.float64]], actuator: str, body: str, parameter: str) -> str:
    if name := _either(numerics, actuator, body, parameter):
        return name
    raise ModelError(f"{body}:{parameter}", f"is missing; thruster '{actuator}' needs it, or '{actuator}:{parameter}'")
