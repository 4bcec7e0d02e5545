"""Other parameters for a compiled model, without compiling it again."""

from __future__ import annotations

import copy
from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import counted
from cube_sim.vehicle.compiled_water import water_of
from cube_sim.vehicle.fin_faults import servo_rows
from cube_sim.vehicle.laws.push import COLUMNS
from cube_sim.vehicle.laws.servo_fault import TARGET
from cube_sim.vehicle.mjcf.ballast import ballast_table
from cube_sim.vehicle.mjcf.elements import element_values, is_of_element, require_possible, set_compiled_element
from cube_sim.vehicle.mjcf.fins import fin_rows
from cube_sim.vehicle.mjcf.half_axes import half_axes_of_all
from cube_sim.vehicle.mjcf.numeric_names import CURRENT, require_mapping, require_parameter
from cube_sim.vehicle.mjcf.parameters import WaterParameters
from cube_sim.vehicle.mjcf.propellers import shaft_lag_s
from cube_sim.vehicle.mjcf.time_step import require_time_step
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.plugin.inverse_weights import set_inverse_weights

_MATRICES = (":added_mass", ":linear_damping", ":quadratic_damping")
_DIAGONAL = 6
_STATES = (layout.EFFICIENCY, layout.SUPPLY, layout.STUCK)
"""What of a thruster's record is of its health and supply, and no parameter."""


def set_parameters(model: mujoco.MjModel, parameters: Mapping[str, ArrayLike]) -> None:
    """Give a compiled model other parameters; every MjData that steps it sees them from its next step on.

    All names that `load_model` takes: the water's custom numerics, and what the elements say (mass, centre of mass,
    inertia, lags). They are validated together, as at load, and nothing is changed if they are refused. Health, supply,
    pushes and, unless it is given, the current stay as they are. A copy of the model (`copy.copy`) has its own
    parameters: `mujoco.rollout` steps many copies side by side. To write into ``model.numeric(...).data`` yourself has
    no effect: the numerics are read here and at load only.

    Args:
        model: made by `load_model`; changed here.
        parameters: name -> values.

    Raises:
        ModelError: no such parameter, values that cannot be, or more of them than the model has room for.
        TypeError: `parameters` are no mapping.
    """
    require_mapping(parameters)
    if not isinstance(model, mujoco.MjModel):
        raise TypeError(f"one mujoco.MjModel is right, not a {type(model).__name__}: of several, one after the other")
    numerics = {each.name: each.data.copy() for each in map(model.numeric, range(model.nnumeric - 1))}
    elements: dict[str, NDArray[np.float64]] = {}
    packed = packing.packed_parameters(model)
    for name, values in parameters.items():
        require_parameter(name)
        given = _numbers(name, values)
        if is_of_element(name):
            require_possible(name, given)
            if element_values(model, name) is None:
                raise ModelError(name, f"'{name.rpartition(':')[0]}' is no body, and no thruster, of the model")
            elements[name] = given
        elif (matrix := _as_matrix(name, given, numerics)) is not None:
            numerics[name] = matrix
        elif name not in numerics or numerics[name].size != given.size:
            had = numerics[name].size if name in numerics else "none"
            raise ModelError(
                name,
                f"has {counted(given.size, 'value')}, the model has room for {had}: give them to load_model, once",
            )
        else:
            numerics[name] = given
    read = water_of(model, numerics)
    trial = model if not elements else _with_elements(model, elements)
    changed = _packed(trial, read, packed, parameters)
    require_time_step(trial)
    means = _means(model)
    _set_elements(model, elements)
    for name in parameters:
        if name in numerics:
            model.numeric(name).data[:] = numerics[name]
    packed[:] = changed
    gears = model.actuator_gear.copy()
    for i, thruster in enumerate(read.thrusters):
        if thruster is not None:
            model.actuator_ctrlrange[i] = thruster.characteristic.commands[[0, -1]]
            if thruster.propeller is not None:
                model.actuator_gear[i, 5] = thruster.propeller.arm
                if thruster.propeller.shaft is not None:
                    model.actuator_dynprm[i, 1] = shaft_lag_s(thruster.propeller)
    data = mujoco.MjData(model)
    if elements or not np.array_equal(gears, model.actuator_gear):
        mujoco.mj_setConst(model, data)
        _set_means(model, means)
    set_inverse_weights(model, data, [model.body(hull.body).id for hull in read.hulls])


def _as_matrix(
    name: str, given: NDArray[np.float64], numerics: Mapping[str, NDArray[np.float64]]
) -> NDArray[np.float64] | None:
    """A diagonal (6,) as the matrix (36,) that the model has room for; None where that is not what is given."""
    room = numerics[name].size if name in numerics else 0
    if name.endswith(_MATRICES) and (given.size, room) == (_DIAGONAL, _DIAGONAL**2):
        return np.diag(given).ravel()
    return None


def _numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.atleast_1d(np.asarray(values, dtype=float)).ravel()
    except (TypeError, ValueError):
        raise ModelError(name, f"is {values!r:.80}; numbers are right") from None


def _with_elements(model: mujoco.MjModel, elements: Mapping[str, NDArray[np.float64]]) -> mujoco.MjModel:
    trial = copy.copy(model)
    _set_elements(trial, elements)
    return trial


def _set_elements(model: mujoco.MjModel, elements: Mapping[str, NDArray[np.float64]]) -> None:
    """As at load: a hull's first, then what is a thruster's own."""
    body = mujoco.mjtObj.mjOBJ_BODY
    for name in sorted(elements, key=lambda each: mujoco.mj_name2id(model, body, each.rpartition(":")[0]) < 0):
        set_compiled_element(model, name, elements[name])


def _means(model: mujoco.MjModel) -> tuple[float, float]:
    """Mean inertia and mean mass, which scale the tolerance of MuJoCo's solver, summed in its order."""
    inertia = sum(model.dof_M0.tolist()) / max(1, model.nv)
    return inertia, sum(model.body_mass[1:].tolist()) / max(1, model.nbody - 1)


def _set_means(model: mujoco.MjModel, before: tuple[float, float]) -> None:
    """MuJoCo's compiler has them of the elements, `mj_setConst` leaves them. What a file says itself stays."""
    for name, then, now in zip(("meaninertia", "meanmass"), before, _means(model), strict=True):
        if getattr(model.stat, name) == then:
            setattr(model.stat, name, now)


def _packed(
    model: mujoco.MjModel, read: WaterParameters, before: NDArray[np.float64], given: Mapping[str, ArrayLike]
) -> NDArray[np.float64]:
    """The packed values, what is no parameter as before."""
    ids, link_ids = ([model.body(each.body).id for each in several] for several in (read.hulls, read.links))
    pushes_at, current_at = int(before[layout.PUSHES]), int(before[layout.CURRENT])
    pushes = int(before[pushes_at]) if pushes_at >= 0 else 0
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    half_axes = half_axes_of_all(model, data, [*ids, *link_ids], [*read.hulls, *read.links])
    packed = packing.pack_parameters(
        read,
        ids,
        [int(model.body_dofadr[i]) for i in ids],
        half_axes[: len(ids)],
        packing.force_records(before),
        float(before[layout.PROCESS]),
        pushes,
        fin_rows(model, read.fins, [hull.body for hull in read.hulls], read.density),
        model,
        np.flatnonzero(before[int(before[layout.THRUSTERS]) :][: model.nu] == layout.FORCE_STATE).tolist(),
        packing.link_places(model, link_ids, half_axes[len(ids) :]),
        ballast_table(model, read.ballast, [hull.body for hull in read.hulls], read.density),
    )
    fixed = [i for i in range(layout.HEADER_SIZE) if i != layout.SURFACE]
    if packed.size != before.size or not np.array_equal(packed[fixed], before[fixed]):
        said = "takes other terms than the model was compiled with: give it to load_model, once"
        raise ModelError(", ".join(given), said)
    table = before[int(before[layout.THRUSTERS]) :][: model.nu]
    for at in table[table >= 0.0].astype(int).tolist():
        for state in _STATES:
            packed[at + state] = before[at + state]
    servo_rows(packed)[:, TARGET:] = servo_rows(before)[:, TARGET:]
    if pushes_at >= 0:
        end = pushes_at + 1 + pushes * COLUMNS
        packed[pushes_at:end] = before[pushes_at:end]
    if current_at >= 0 and CURRENT not in given:
        n_t, n_z = int(before[current_at]), int(before[current_at + 1])
        end = current_at + 2 + n_t + n_z + 3 * n_t * n_z
        packed[current_at:end] = before[current_at:end]
    return packed
