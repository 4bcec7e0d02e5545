"""The water's parameters packed into a compiled model, and found there again.

`load_model` appends one custom numeric as the last of the model. A compiled callback can read it without names, locks
or state, and it travels with every copy of the model into threads, processes and files.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.laws.ballast import COLUMNS as BALLAST_COLUMNS
from cube_sim.vehicle.laws.body_lift import PRODUCT_COLUMNS, STRIP_COLUMNS
from cube_sim.vehicle.laws.fin import COLUMNS as FIN_COLUMNS
from cube_sim.vehicle.laws.push import COLUMNS, HULL
from cube_sim.vehicle.laws.servo_fault import WHOLE
from cube_sim.vehicle.mjcf.parameters import CurrentProfile, ThrusterParameters, WaterParameters
from cube_sim.vehicle.mjcf.water_body import WaterBody
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.propeller_record import place_propellers, propeller_rows


class ForceRecord(NamedTuple):
    """The own force of a hull, as its record has it.

    Attributes:
        place: in the table of this process; -1 for none.
        sees: whether it sees commands and activations.
        states: how many numbers it keeps.
        state: where they lie among the activations.
        rates: where their rates lie among the user data.
        command: the first of the actuators that it sees.
        commands: how many of them it sees.
        activation: where their activations begin.
        activations: how many these are.
    """

    place: int
    sees: bool
    states: int
    state: int
    rates: int
    command: int
    commands: int
    activation: int
    activations: int


NO_FORCE = ForceRecord(-1, False, *[0] * 7)
_FORCE_COLUMNS = (
    layout.FORCE,
    layout.SEES,
    layout.STATES,
    layout.STATE,
    layout.RATES,
    layout.COMMAND,
    layout.COMMANDS,
    layout.ACTIVATION,
    layout.ACTIVATIONS,
)
"""Of a hull record, in the order of `ForceRecord`."""


class LinkPlace(NamedTuple):
    """Where a link is in a compiled model.

    Attributes:
        body: its index.
        last_dof: the last degree of freedom that moves it.
        arm: how many degrees of freedom its tree has behind the hull's six.
        half_axes: (3,) of its ellipsoid [m].
    """

    body: int
    last_dof: int
    arm: int
    half_axes: NDArray[np.float64]


def link_places(
    model: mujoco.MjModel, links: Sequence[int], half_axes: Sequence[NDArray[np.float64]]
) -> list[LinkPlace]:
    """Where links are, by their indices and (3,) half-axes."""
    places = []
    for body, axes in zip(links, half_axes, strict=True):
        mover = body
        while model.body_dofnum[mover] == 0:  # fixed on what carries it
            mover = int(model.body_parentid[mover])
        last = int(model.body_dofadr[mover] + model.body_dofnum[mover]) - 1
        arm = int(model.tree_dofnum[model.body_treeid[body]]) - 6
        places.append(LinkPlace(body, last, arm, axes))
    return places


def pack_parameters(
    parameters: WaterParameters,
    bodies: list[int],
    dofs: list[int],
    half_axes: Sequence[NDArray[np.float64]],
    forces: Sequence[ForceRecord],
    process: float,
    pushes: int = 0,
    fins: NDArray[np.float64] | None = None,
    model: mujoco.MjModel | None = None,
    states: Collection[int] = (),
    links: Sequence[LinkPlace] = (),
    ballast: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """(n,) values as `cube_sim.vehicle.plugin.layout` says.

    Args:
        parameters: what the MJCF says, validated.
        bodies: body index of each hull in the compiled model.
        dofs: address of each hull's first degree of freedom.
        half_axes: (3,) of each hull's ellipsoid [m], see `cube_sim.vehicle.laws.surface`.
        forces: the own force of each hull.
        process: number of this process.
        pushes: for how many there is to be room.
        fins: (n,16) the table of `cube_sim.vehicle.laws.fin`; zeros where it is not known yet.
        model: compiled, for the places of propellers; None where there is none yet.
        states: the actuators that keep the state of an own force.
        links: where each link is.
        ballast: (n,9) the table of `cube_sim.vehicle.laws.ballast`; zeros where it is not known yet.
    """
    hulls = [_hull_record(*row) for row in zip(parameters.hulls, bodies, dofs, half_axes, forces, strict=True)]
    for record, hull in zip(hulls, parameters.hulls, strict=True):
        record[layout.ARM] = max(
            (at.arm for at, link in zip(links, parameters.links, strict=True) if link.hull == hull.body), default=0
        )
    hulls += [
        _hull_record(link, at.body, at.last_dof, at.half_axes, NO_FORCE)
        for link, at in zip(parameters.links, links, strict=True)
    ]
    table_start = layout.HEADER_SIZE + layout.HULL_SIZE * len(hulls)
    end = table_start + len(parameters.thrusters)
    table: list[float] = []
    curves: list[NDArray[np.float64]] = []
    propellers = 0
    servos, pumps = {fin.servo for fin in parameters.fins}, {each.pump for each in parameters.ballast}
    for actuator, thruster in enumerate(parameters.thrusters):
        if thruster is None:
            other = layout.FORCE_STATE if actuator in states else layout.NO_THRUSTER
            other = layout.BALLAST_STATE if actuator in pumps else other
            table.append(float(layout.FIN_SERVO if actuator in servos else other))
            continue
        table.append(float(end))
        number, propellers = (-1, propellers) if thruster.propeller is None else (propellers, propellers + 1)
        curves.append(_curve_record(thruster, number))
        end += curves[-1].size
    current = _current_record(parameters.current)
    current_start = end if current.size else -1.0
    pushed = _push_record(pushes)
    pushes_start = end + current.size if pushed.size else -1.0
    lift = _lift_record(parameters, fins)
    end += current.size + pushed.size
    lift_start = end if lift.size else -1.0
    turning = _propeller_record(parameters, table, model)
    propellers_start = end + lift.size if turning.size else -1.0
    starts = layout.HEADER_SIZE, table_start, current_start, process, pushes_start, lift_start, parameters.surface
    count, of_links = len(parameters.hulls), len(parameters.links)
    links_start = layout.HEADER_SIZE + layout.HULL_SIZE * count if of_links else -1.0
    end += lift.size + turning.size
    tanks, turned = _ballast_record(parameters, ballast), _servo_record(parameters)
    ends = of_links, links_start, end if tanks.size else -1.0, end + tanks.size if turned.size else -1.0
    header = np.array([layout.MAGIC, count, *starts, propellers_start, *ends])
    at_voltages = _voltage_records(parameters, curves, end + tanks.size + turned.size)
    records = *curves, current, pushed, lift, turning, tanks, turned, *at_voltages
    return np.concatenate([header, *hulls, np.array(table), *records])


def packed_size(parameters: WaterParameters, pushes: int = 0) -> int:
    """Number of values `pack_parameters` will return."""
    n, places = len(parameters.hulls), [LinkPlace(0, 0, 0, np.zeros(3))] * len(parameters.links)
    zeros = [np.zeros(3)] * n
    return pack_parameters(parameters, [0] * n, [0] * n, zeros, [NO_FORCE] * n, 0.0, pushes, links=places).size


def packed_parameters(model: mujoco.MjModel) -> NDArray[np.float64]:
    """The (n,) packed values of a compiled model: a view, to read and to write.

    Raises:
        ModelError: the model has none.
    """
    if model.nnumeric:
        start = model.numeric_adr[model.nnumeric - 1]
        packed = model.numeric_data[start : start + model.numeric_size[model.nnumeric - 1]]
        if packed[0] == layout.MAGIC:
            return packed
    raise ModelError("", "the model has no water; compile it with cube_sim.load_model")


def force_records(packed: NDArray[np.float64]) -> list[ForceRecord]:
    """The own force of each hull, by the packed values."""
    start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
    records = packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)
    rows = records[:, _FORCE_COLUMNS].astype(int).tolist()
    return [ForceRecord(place, bool(sees), *rest) for place, sees, *rest in rows]


def _hull_record(
    hull: WaterBody, body: int, dof: int, half_axes: NDArray[np.float64], force: ForceRecord
) -> NDArray[np.float64]:
    record = np.zeros(layout.HULL_SIZE)
    record[layout.BODY], record[layout.DOF], record[layout.DISPLACED_MASS] = body, dof, hull.displaced_mass
    record[layout.CENTRE : layout.ADDED_MASS] = hull.centre_of_buoyancy
    record[layout.ADDED_MASS : layout.LINEAR] = hull.added_mass.ravel()
    record[layout.LINEAR : layout.QUADRATIC] = hull.linear_damping.T.ravel()
    record[layout.QUADRATIC : layout.FORCE] = hull.quadratic_damping.T.ravel()
    record[[*_FORCE_COLUMNS]] = force
    largest = float(half_axes.max())
    record[layout.REACH] = largest + np.linalg.norm(hull.centre_of_buoyancy) if largest > 0.0 else -np.inf
    record[layout.HALF_AXES : layout.SEES] = half_axes
    return record


def _curve_record(thruster: ThrusterParameters, propeller: int) -> NDArray[np.float64]:
    curve = thruster.characteristic
    healthy = (1.0, 1.0, np.nan)  # efficiency, supply, not stuck
    head = [*curve.command_dead_zone, *curve.force_dead_zone, curve.commands.size, *healthy, *thruster.power]
    wires = [np.nan if thruster.voltage is None else thruster.voltage, *(thruster.pulse_us or [np.nan] * 3)]
    return np.concatenate([np.array([*head, *wires, propeller, -1.0]), curve.commands, curve.forces])


def _push_record(pushes: int) -> NDArray[np.float64]:
    if not pushes:
        return np.empty(0)
    rows = np.zeros((pushes, COLUMNS))
    rows[:, HULL] = -1.0
    return np.concatenate([[float(pushes)], rows.ravel()])


def _lift_record(parameters: WaterParameters, fins: NDArray[np.float64] | None) -> NDArray[np.float64]:
    products = _of_hulls([hull.products for hull in parameters.hulls], PRODUCT_COLUMNS)
    strips = _of_hulls([hull.strips for hull in parameters.hulls], STRIP_COLUMNS)
    table = np.zeros((len(parameters.fins), FIN_COLUMNS)) if fins is None else fins
    linear, square = (_of_fins(parameters, power) for power in (1.0, 2.0))
    tables = products, strips, table, linear, square
    if not any(len(each) for each in tables):
        return np.empty(0)
    return np.concatenate([np.array([len(each) for each in tables], dtype=float), *(each.ravel() for each in tables)])


def _ballast_record(parameters: WaterParameters, table: NDArray[np.float64] | None) -> NDArray[np.float64]:
    n = len(parameters.ballast)
    if not n:
        return np.empty(0)
    return np.concatenate([[float(n)], np.zeros(n * BALLAST_COLUMNS) if table is None else table.ravel()])


def _servo_record(parameters: WaterParameters) -> NDArray[np.float64]:
    rows = [[float(fin.servo), float(k), *WHOLE] for k, fin in enumerate(parameters.fins) if fin.servo is not None]
    return np.concatenate([[float(len(rows))], np.ravel(rows)]) if rows else np.empty(0)


def _of_fins(parameters: WaterParameters, power: float) -> NDArray[np.float64]:
    """(n, columns) products with that power of a deflection, the number of the fin before each."""
    return _of_hulls([fin.products[fin.products[:, -1] == power, :-1] for fin in parameters.fins], PRODUCT_COLUMNS)


def _voltage_records(
    parameters: WaterParameters, curves: Sequence[NDArray[np.float64]], start: int
) -> list[NDArray[np.float64]]:
    """One for each table; curve records (n,) get to know where theirs begins. The first begins at `start`."""
    thrusters = [thruster for thruster in parameters.thrusters if thruster is not None]
    begins: dict[str, int] = {}
    records = []
    for thruster, curve in zip(thrusters, curves, strict=True):
        of = thruster.voltages
        if of is None:
            continue
        if of.source not in begins:
            begins[of.source] = start
            each = [
                np.concatenate([power, at.command_dead_zone, at.force_dead_zone, at.commands, at.forces])
                for power, at in zip(of.power, of.curves, strict=True)
            ]
            head = np.array([float(len(of.voltages)), float(of.curves[0].commands.size), *of.voltages])
            records.append(np.concatenate([head, *each]))
            start += records[-1].size
        curve[layout.TABLES] = begins[of.source]
    return records


def _propeller_record(
    parameters: WaterParameters, curves: Sequence[float], model: mujoco.MjModel | None
) -> NDArray[np.float64]:
    propellers = [None if thruster is None else thruster.propeller for thruster in parameters.thrusters]
    rows, points = propeller_rows(propellers, [hull.body for hull in parameters.hulls], [int(at) for at in curves])
    if not len(rows):
        return np.empty(0)
    if model is not None:
        place_propellers(model, propellers, rows)
    return np.concatenate([[float(len(rows)), float(points.size)], rows.ravel(), points])


def _of_hulls(rows: list[NDArray[np.float64]], columns: int) -> NDArray[np.float64]:
    """(n, columns) the rows of all hulls, or fins, the number of it before each."""
    numbered = [np.empty((0, columns)), *(np.insert(each, 0, float(k), axis=1) for k, each in enumerate(rows))]
    return np.concatenate(numbered).reshape(-1, columns)


def _current_record(profile: CurrentProfile | None) -> NDArray[np.float64]:
    if profile is None:
        return np.empty(0)
    sizes = np.array([profile.times_s.size, profile.heights.size], dtype=float)
    return np.concatenate([sizes, profile.times_s, profile.heights, profile.velocities.ravel()])
