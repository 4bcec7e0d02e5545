"""From an MJCF file to a compiled model whose every step includes the water."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.mjcf.ballast import ballast_table, pump_elements
from cube_sim.vehicle.mjcf.elements import is_of_element, set_elements
from cube_sim.vehicle.mjcf.fins import AREA, fin_rows, servo_elements
from cube_sim.vehicle.mjcf.half_axes import half_axes_of_all
from cube_sim.vehicle.mjcf.numeric_names import (
    bodies_in_water,
    force_owner,
    one_water,
    require_mapping,
    require_parameter,
)
from cube_sim.vehicle.mjcf.parameters import read_parameters
from cube_sim.vehicle.mjcf.places import place_in_words, place_of
from cube_sim.vehicle.mjcf.propellers import fastest_change_s, shaft_lag_s
from cube_sim.vehicle.mjcf.thruster_elements import (
    limit_commands,
    set_gears,
    set_shaft_lags,
    thruster_elements,
)
from cube_sim.vehicle.mjcf.time_step import require_time_step
from cube_sim.vehicle.mjcf.unused import keep_words, kept_words, unused_thruster_words
from cube_sim.vehicle.plugin import hook, layout, packing, structs, user_forces
from cube_sim.vehicle.plugin.inverse_weights import set_inverse_weights
from cube_sim.vehicle.plugin.user_force_kinds import ForceKind, UserForce, kind_of
from cube_sim.vehicle.plugin.warnings import collect_warnings
from cube_sim.vehicle.unlikely.words import unlikely_words


def load_model(
    path: str | Path | mujoco.MjSpec,
    parameters: Mapping[str, ArrayLike] | None = None,
    forces: Mapping[str, UserForce] | None = None,
    pushes: int = 0,
) -> mujoco.MjModel:
    """Compile a model with water.

    The returned model is an ordinary `mujoco.MjModel`: mj_step, rollout, batch and the viewer step it with added mass,
    drag, buoyancy, current (`model.opt.wind` [m/s], world axes) and thrusters included. The water is endless unless
    `water:surface` says how high its surface is, in the file or among `parameters`. MuJoCo's own warnings about the
    file become Python's, instead of a MUJOCO_LOG.TXT in the working directory.

    Args:
        path: an MJCF file, or a spec built in memory (left as it is).
        parameters: values that take the place of the MJCF's custom numerics of the same name, e.g.
            ``{"hull:thruster_dead_zone": (-2.0, 2.0)}``; see `cube_sim.vehicle.mjcf.parameters` for the names. Mass,
            inertia and lags as well, which the MJCF has in its elements: see `cube_sim.vehicle.mjcf.elements`.
        forces: hull -> a force of your own, see `cube_sim.vehicle.plugin.user_forces`. The MJCF can name one too:
            ``<text name="hull:force" data="package.module:function"/>``.
        pushes: for how many forces from outside there is to be room, see `cube_sim.vehicle.pushes`.

    Raises:
        ModelError: the file cannot be read or compiled, or its water makes no sense; names the element.
        TypeError: `parameters` or `forces` are no mapping.
    """
    model = load_unsaid(path, parameters, forces, pushes)
    for text in (*kept_words(model), *unlikely_words(model)):
        warnings.warn(text, stacklevel=2)
    return model


def load_unsaid(
    path: str | Path | mujoco.MjSpec,
    parameters: Mapping[str, ArrayLike] | None = None,
    forces: Mapping[str, UserForce] | None = None,
    pushes: int = 0,
    own_actuators: Mapping[str, range] | None = None,
) -> mujoco.MjModel:
    """The same model for a caller who says himself what is to be said of it; errors are the same.

    Args:
        path: as for `load_model`, and so are the next three.
        parameters: name -> values.
        forces: hull -> a force of your own.
        pushes: for how many forces from outside there is to be room.
        own_actuators: hull -> those that its own force counts, where several files are joined in a spec; all of them
            where nothing is said of it.
    """
    for given in (parameters, forces):
        if given is not None:
            require_mapping(given)
    with collect_warnings() as spoken:
        model = _load(path, dict(parameters or {}), dict(forces or {}), pushes, own_actuators or {})
    for text in spoken:
        warnings.warn(f"MuJoCo: {text}", stacklevel=3)
    return model


def _load(
    path: str | Path | mujoco.MjSpec,
    parameters: dict[str, ArrayLike],
    forces: dict[str, UserForce],
    pushes: int,
    own_actuators: Mapping[str, range],
) -> mujoco.MjModel:
    if isinstance(path, (str, Path)):
        spec, name = _read(Path(path)), str(path)
    elif isinstance(path, mujoco.MjSpec):
        spec, name = path, path.modelname
    else:
        raise ModelError("", f"a model is loaded from an MJCF file or an MjSpec, not from {_kind(path)}")
    file = None if spec is path else Path(name)
    try:
        return _immerse(_own_copy(spec) if spec is path else spec, parameters, forces, pushes, own_actuators)
    except ModelError as error:
        by_file = file is not None and error.element not in parameters
        place = place_of(file, error.element) if by_file and file is not None else None
        raise ModelError(error.element, error.reason, name, "" if place is None else str(place)) from None
    except ValueError as error:  # MuJoCo's compiler
        place, words = (name, _one_line(error)) if file is None else place_in_words(file, _one_line(error))
        raise ModelError("compile", words, name, place) from None


def _kind(thing: object) -> str:
    compiled = isinstance(thing, mujoco.MjModel)
    return "an MjModel, which is compiled already" if compiled else repr(thing)


def _own_copy(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """A copy to write into.

    MuJoCo leaves out of a copy, without a word, what refers to something that is not there: that is refused here.
    """
    thruster_elements(spec)
    copy = spec.copy()
    for kind in ("actuators", "sensors", "equalities", "tendons", "pairs", "excludes"):
        before, after = (Counter(element.name for element in getattr(one, kind)) for one in (spec, copy))
        for lost in before - after:
            raise ModelError(lost or f"one of the {kind}", "refers to an element that the model does not have")
    return copy


def _read(path: Path) -> mujoco.MjSpec:
    if not path.is_file():
        raise ModelError("", "no such model file", str(path))
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        place, words = place_in_words(path, _one_line(error))
        raise ModelError("", words, str(path), place) from None


def _immerse(
    spec: mujoco.MjSpec,
    overrides: dict[str, ArrayLike],
    forces: dict[str, UserForce],
    pushes: int,
    own_actuators: Mapping[str, range],
) -> mujoco.MjModel:
    hook.install()
    numerics = {n.name: np.array(n.data, dtype=float) for n in spec.numerics}
    in_file = tuple(numerics)
    of_elements: dict[str, NDArray[np.float64]] = {}
    for name, values in overrides.items():
        require_parameter(name)
        (of_elements if is_of_element(name) else numerics)[name] = _numbers(name, values)
    if layout.PACKED in numerics:
        raise ModelError(layout.PACKED, "is written by load_model; remove it from the MJCF")
    _say_in_the_model(spec, {name: numerics[name] for name in overrides if name in numerics})
    bodies = {body.name: _carrier(body) for body in spec.bodies if body.name and body.name != "world"}
    thrusters = thruster_elements(spec)
    sites = {site.name: site.parent.name for site in spec.sites if site.name}
    others = [actuator.name for actuator, each in zip(spec.actuators, thrusters, strict=True) if each is None]
    bodies_in_water(one_water(numerics), list(bodies), [each.name for each in thrusters if each], sites, others)
    pumps = pump_elements(spec, numerics)
    servos = servo_elements(spec, [site for site in sites if f"{site}:{AREA}" in numerics], pumps.values())
    parameters = read_parameters(numerics, bodies, thrusters, sites, servos, pumps)
    hulls = [hull.body for hull in parameters.hulls]
    keep_words(spec, unused_thruster_words(spec, in_file, hulls, thrusters, [*servos.values(), *pumps.values()]))
    links = [link.body for link in parameters.links]
    set_elements(spec, of_elements, [*bodies], thrusters)
    limit_commands(spec, [thruster and thruster.characteristic for thruster in parameters.thrusters])
    shafts = [each and each.propeller and each.propeller.shaft and each.propeller for each in parameters.thrusters]
    set_shaft_lags(spec, [each and shaft_lag_s(each) for each in shafts])
    set_gears(spec, [each and each.propeller and each.propeller.arm for each in parameters.thrusters])
    for text in spec.texts:
        if (owner := force_owner(text.name, text.data, list(bodies))) is not None:
            forces.setdefault(owner, user_forces.resolve(text.data, text.name))
    _require_usable_options(spec)
    for body in forces:
        if body not in hulls:
            raise ModelError(f"{body}:force", f"no hull '{body}'; the model has {among(body, hulls)}")
    kinds = {hull: kind_of(function, f"{hull}:force") for hull, function in forces.items()}
    in_files = range(len(spec.actuators))
    kept = {in_files.stop + k: h for k, h in enumerate(h for h in hulls if h in kinds and kinds[h].states)}
    parameters = replace(parameters, thrusters=(*parameters.thrusters, *[None] * len(kept)))
    rates: dict[str, int] = {}
    for hull in kept.values():
        rates[hull] = _keep_state(spec, hull, kinds[hull].states)
    for hull in hulls:
        _prepare(spec, hull)
    spec.add_numeric(name=layout.PACKED, size=packing.packed_size(parameters, pushes), data=[0.0])
    model = spec.compile()
    require_time_step(model)
    for index, each in enumerate(shafts):
        if each and fastest_change_s(each) < 0.5 * model.opt.timestep:
            text = f"has a shaft that settles within {fastest_change_s(each):.2g} s"
            raise ModelError(
                model.actuator(index).name, f"{text}; a time step of at most twice that is right, or a larger inertia"
            )
    if np.any(model.tendon_armature != 0.0):
        raise ModelError("tendon", "has armature, which a hull's inertia has no room for; put armature on a joint")
    ids = [model.body(name).id for name in hulls]
    for name in links:
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) < 0:
            raise ModelError(name, 'has water, and fusestatic="true" makes it a part of what carries it; put "false"')
    link_ids = [model.body(name).id for name in links]
    dofs = [int(model.body_dofadr[i]) for i in ids]
    start = model.numeric_adr[model.nnumeric - 1]
    lie = {hull: (int(model.actuator_actadr[index]), rates[hull]) for index, hull in kept.items()}
    table = [
        _force(model, hull, forces, kinds, lie.get(hull, (0, 0)), own_actuators.get(hull, in_files)) for hull in hulls
    ]
    fins = fin_rows(model, parameters.fins, hulls, parameters.density)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    half_axes = half_axes_of_all(model, data, [*ids, *link_ids], [*parameters.hulls, *parameters.links])
    places = packing.link_places(model, link_ids, half_axes[len(ids) :])
    process, half_axes = user_forces.process_number(), half_axes[: len(ids)]
    ballast = ballast_table(model, parameters.ballast, hulls, parameters.density)
    by_model = fins, model, kept, places, ballast
    packed = packing.pack_parameters(parameters, ids, dofs, half_axes, table, process, pushes, *by_model)
    model.numeric_data[start : start + packed.size] = packed
    structs.verify(model, data)
    set_inverse_weights(model, data, ids)
    return model


def _say_in_the_model(spec: mujoco.MjSpec, numerics: dict[str, NDArray[np.float64]]) -> None:
    """Put numerics into a spec, in place of its own: a compiled model says what it was made with."""
    there = {numeric.name: numeric for numeric in spec.numerics}
    for name, values in numerics.items():
        flat = values.ravel()
        if name in there:
            there[name].data, there[name].size = flat, flat.size
        else:
            spec.add_numeric(name=name, size=flat.size, data=flat)


def _force(
    model: mujoco.MjModel,
    hull: str,
    forces: dict[str, UserForce],
    kinds: dict[str, ForceKind],
    lies: tuple[int, int],
    seen: range,
) -> packing.ForceRecord:
    """The own force of a hull in the table of this process, where its state and rates lie, and what it sees."""
    if hull not in forces:
        return packing.NO_FORCE
    body, kind = model.body(hull), kinds[hull]
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, body.quat)
    activations = _activations(model, seen)
    at_rest = user_forces.AtRest(
        body.pos.copy(), rotation.reshape(3, 3), np.zeros(len(seen)), np.zeros(len(activations))
    )
    place = user_forces.register(forces[hull], kind, f"{hull}:force", at_rest)
    window = seen.start, len(seen), activations.start, len(activations)
    return packing.ForceRecord(place, kind.sees, kind.states, *lies, *window)


def _activations(model: mujoco.MjModel, actuators: range) -> range:
    """Where the activations of neighbouring actuators lie: MuJoCo gives them out in the order of the actuators."""
    lagged = [i for i in actuators if model.actuator_actnum[i] > 0]
    if not lagged:
        return range(0)
    last = lagged[-1]
    return range(int(model.actuator_actadr[lagged[0]]), int(model.actuator_actadr[last] + model.actuator_actnum[last]))


def _keep_state(spec: mujoco.MjSpec, hull: str, states: int) -> int:
    """Give a model an actuator that pushes nothing, whose activations are the state of a hull's own force.

    Returns:
        Where there is room for its rates among the user data.
    """
    name = f"{hull}:force_state"
    site = spec.body(hull).add_site(name=name)
    actuator = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_SITE, target=site.name)
    actuator.dyntype, actuator.gainprm[0], actuator.actdim = mujoco.mjtDyn.mjDYN_USER, 0.0, states
    actuator.dynprm[0] = 0.0  # no lag
    begin = max(spec.nuserdata, 0)
    spec.nuserdata = begin + states
    return begin


def _numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise ModelError(name, f"is {values!r:.80}; numbers are right") from None


def _require_usable_options(spec: mujoco.MjSpec) -> None:
    option = spec.option
    for name in ("timestep", "gravity", "wind"):
        value = np.array(getattr(option, name), dtype=float)
        if not np.all(np.isfinite(value)):
            raise ModelError("option", f"{name} is {' '.join(f'{x:g}' for x in value.flat)}; finite numbers are right")
    if option.density or option.viscosity:
        raise ModelError(
            "option", "density and viscosity switch MuJoCo's own fluid model on; put 0 and use water:density"
        )
    off = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    if option.disableflags & off == off:
        raise ModelError("option", "disabling both spring and damper skips the passive stage, and the water with it")


def _carrier(body: mujoco.MjsBody) -> str | None:
    """Name of the free body of the world that a body is, or that carries it; None where there is none."""
    while body.parent.name != "world":
        body = body.parent
    free = [joint.type for joint in body.joints] == [mujoco.mjtJoint.mjJNT_FREE]
    return body.name if free else None


def _prepare(spec: mujoco.MjSpec, name: str) -> None:
    """Turn off what MuJoCo would make simpler about a body than its water is."""
    body = spec.body(name)
    body.simple = 0  # otherwise M has no room for what couples the axes
    body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_NEVER  # otherwise a current could not pick it up again
    body.joints[0].align = mujoco.mjtAlignFree.mjALIGNFREE_FALSE  # otherwise the axes its numbers are about could move


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
