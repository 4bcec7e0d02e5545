"""Which actuators of an MJCF are thrusters, and what MuJoCo must be told about one for its force to be the curve's.

A thruster is ``biastype="user"`` on a site of a vehicle: command -> lag -> characteristic -> force along the site's z
axis. Allocation and analysis rely on that force, as `Vehicle.thrusters` gives it. Whatever else MuJoCo can do to an
actuator would change it, so it is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.characteristic import Characteristic

_LAGS = {
    mujoco.mjtDyn.mjDYN_FILTER: "filter",
    mujoco.mjtDyn.mjDYN_FILTEREXACT: "filterexact",
    mujoco.mjtDyn.mjDYN_USER: "user",
}
"""One lag, one that MuJoCo integrates exactly, or two in a row: of the speed controller and of the rotor."""
_FREE_GEAR = [2, 5]  # thrust along the site's z axis, reaction torque about it


@dataclass(frozen=True)
class ThrusterElement:
    """One thruster of the MJCF.

    Attributes:
        name: of the actuator.
        body: the body of the world that carries its site.
        site: that it pushes at.
        site_body: the body that the site is on.
    """

    name: str
    body: str
    site: str
    site_body: str


def thruster_elements(spec: mujoco.MjSpec) -> list[ThrusterElement | None]:
    """One entry per actuator of the spec; None for one that is no thruster.

    Raises:
        ModelError: a thruster MuJoCo would not run as its characteristic says; names the actuator.
    """
    return [
        _element(spec, actuator, index) if actuator.biastype == mujoco.mjtBias.mjBIAS_USER else None
        for index, actuator in enumerate(spec.actuators)
    ]


def thruster_actuators(model: mujoco.MjModel, hull: int) -> list[int]:
    """Actuators of a compiled model that are thrusters of one hull: those of `thruster_elements`, in their order.

    A thruster's site may be on the hull itself or on any body that the hull carries.

    Args:
        model: compiled, with or without its water.
        hull: index of the body of the world that carries them.
    """
    return [i for i in range(model.nu) if is_thruster(model, i) and carrier(model, i) == hull]


def is_thruster(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether an actuator of a compiled model is a thruster."""
    return bool(model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_USER)


def carrier(model: mujoco.MjModel, actuator: int) -> int:
    """The body of the world that carries the site an actuator pushes; the world for an actuator without one."""
    if model.actuator_trntype[actuator] != mujoco.mjtTrn.mjTRN_SITE:
        return 0
    return int(model.body_rootid[model.site_bodyid[model.actuator_trnid[actuator, 0]]])


def require_fixed_thrusters(model: mujoco.MjModel, hull: int) -> None:
    """Refuse a thruster that moves against its hull, where one matrix is to say what each thruster does.

    MuJoCo steps it as it is. But nothing that shares out a force between thrusters follows the joint.

    Args:
        model: compiled, with or without its water.
        hull: index of the body of the world that carries them.

    Raises:
        ModelError: names the thruster, and the joint that lies between.
    """
    for actuator in thruster_actuators(model, hull):
        body = int(model.site_bodyid[model.actuator_trnid[actuator, 0]])
        carried_by = body
        while carried_by != hull:
            if model.body_jntnum[carried_by]:
                joint, itself = model.joint(int(model.body_jntadr[carried_by])).name, model.body(hull).name
                mover = f"joint '{joint}'" if joint else "a joint"
                raise ModelError(
                    model.actuator(actuator).name,
                    f"is a thruster on '{model.body(body).name}', which {mover} moves against '{itself}'; a site on "
                    f"'{itself}', or on what no joint moves, is right: what shares out forces takes thrusters to stay "
                    "where they are, one that swivels too. Take the joint out, and it pushes one way; or "
                    "step the model yourself: load_model takes it as it is",
                )
            carried_by = int(model.body_parentid[carried_by])


def thruster_element(model: mujoco.MjModel, actuator: int) -> ThrusterElement:
    """One of `thruster_elements` of a compiled model."""
    site = int(model.actuator_trnid[actuator, 0])
    bodies = carrier(model, actuator), model.site_bodyid[site]
    body, site_body = (model.body(each).name for each in bodies)
    return ThrusterElement(model.actuator(actuator).name, body, model.site(site).name, site_body)


def limit_commands(spec: mujoco.MjSpec, curves: Sequence[Characteristic | None]) -> None:
    """Hold every command to the ends of its curve, also where the MJCF allows more.

    The curve saturates anyway. But a command beyond its end would pass the lag faster than a motor does, and would keep
    it from turning back.

    Args:
        spec: changed here.
        curves: one entry per actuator; None for one that is no thruster.

    Raises:
        ModelError: a range of the MJCF cuts off a part of the curve, which `Vehicle.thrusters` would promise.
    """
    for actuator, curve in zip(spec.actuators, curves, strict=True):
        if curve is None:
            continue
        if actuator.dyntype == mujoco.mjtDyn.mjDYN_USER:
            actuator.actdim = 2
        commands, forces = (float(curve.commands[0]), float(curve.commands[-1])), curve.limits[[0, -1]]
        if is_limited(spec, actuator.ctrllimited, actuator.ctrlrange):
            _require_inside(actuator.name, "ctrlrange", actuator.ctrlrange, commands, "leave it out or widen it")
        actuator.ctrllimited, actuator.ctrlrange = mujoco.mjtLimited.mjLIMITED_TRUE, commands
        if is_limited(spec, actuator.actlimited, actuator.actrange):
            _require_inside(actuator.name, "actrange", actuator.actrange, commands, "leave it out or widen it")
        if is_limited(spec, actuator.forcelimited, actuator.forcerange):
            _require_inside(actuator.name, "forcerange", actuator.forcerange, forces, "the curve is the limit")


def set_gears(spec: mujoco.MjSpec, arms: Sequence[float | None]) -> None:
    """Let propellers turn the hull by their torque at rest.

    Args:
        spec: changed here.
        arms: torque per newton of each actuator [m]; None for one that is no propeller.

    Raises:
        ModelError: a propeller with a gear of its own.
    """
    for actuator, arm in zip(spec.actuators, arms, strict=True):
        if arm is None:
            continue
        if not np.array_equal(actuator.gear, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]):
            raise ModelError(
                actuator.name,
                f'has gear "{" ".join(f"{g:g}" for g in actuator.gear)}"; "0 0 1 0 0 0" is right for a propeller: its '
                "torque follows from K_Q and propeller_hand",
            )
        actuator.gear = [0.0, 0.0, 1.0, 0.0, 0.0, arm]


def set_shaft_lags(spec: mujoco.MjSpec, lags: Sequence[float | None]) -> None:
    """Let the model say how long the shafts of motors take to settle.

    Args:
        spec: changed here.
        lags: one entry per actuator [s]; None for one that has no motor.

    Raises:
        ModelError: a motor whose shaft MuJoCo would not integrate.
    """
    for actuator, lag_s in zip(spec.actuators, lags, strict=True):
        if lag_s is None:
            continue
        if actuator.dyntype != mujoco.mjtDyn.mjDYN_USER:
            raise ModelError(actuator.name, 'has a motor; dyntype="user" dynprm="T1 T2" is right: voltage and shaft')
        actuator.dynprm[1] = lag_s


def _element(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator, index: int) -> ThrusterElement:
    name = actuator.name
    if not name:
        raise ModelError(f"actuator {index}", 'has biastype "user" but no name; a thruster needs one')
    _require_lag(actuator)
    gain_is_zero = actuator.gaintype == mujoco.mjtGain.mjGAIN_FIXED and actuator.gainprm[0] == 0.0
    if not gain_is_zero:
        raise ModelError(name, 'has a gain of MuJoCo beside its characteristic; put gaintype="fixed" gainprm="0"')
    _require_push_along_z(actuator)
    body = _carrier(spec, actuator)
    return ThrusterElement(name, body, actuator.target, spec.site(actuator.target).parent.name)


def _require_lag(actuator: mujoco.MjsActuator) -> None:
    if actuator.dyntype == mujoco.mjtDyn.mjDYN_NONE:
        raise ModelError(actuator.name, 'is a thruster without dyntype="filter", the lag of its motor [s] in dynprm')
    if actuator.dyntype not in _LAGS:
        kind = actuator.dyntype.name.removeprefix("mjDYN_").lower()
        raise ModelError(
            actuator.name, f'has dyntype "{kind}"; the lag of a motor is {" or ".join(map(repr, _LAGS.values()))}'
        )
    two = actuator.dyntype == mujoco.mjtDyn.mjDYN_USER
    for lag_s in np.array(actuator.dynprm[: 2 if two else 1]).tolist():
        if not 0.0 < lag_s < np.inf:
            them = ' of two; with dyntype "user" both are' if two else "; it is"
            raise ModelError(actuator.name, f"has a lag (dynprm) of {lag_s:g} s{them} positive and finite")
    if two and actuator.delay:
        raise ModelError(
            actuator.name, 'has a delay beside two lags, which dyntype "user" cannot have; put it into them'
        )


def _require_push_along_z(actuator: mujoco.MjsActuator) -> None:
    gear = np.array(actuator.gear)
    if not np.all(np.isfinite(gear)) or np.any(np.delete(gear, _FREE_GEAR)) or gear[2] == 0.0:
        raise ModelError(
            actuator.name,
            f'has gear "{" ".join(f"{g:g}" for g in gear)}"; a thruster pushes along its site\'s z axis: '
            '"0 0 g 0 0 k", g the thrust per newton of its characteristic, k its reaction torque [N m]; turn the site',
        )


def _carrier(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator) -> str:
    """Name of the body of the world that the actuator's site is on."""
    name = actuator.name
    if actuator.trntype != mujoco.mjtTrn.mjTRN_SITE:
        raise ModelError(name, 'has biastype "user" but no site; a thruster pushes along a site\'s z axis')
    if actuator.refsite:
        raise ModelError(name, f"has refsite '{actuator.refsite}'; a thruster pushes along its own site's z axis")
    site = spec.site(actuator.target)
    if site is None:
        sites = [site.name for site in spec.sites if site.name]
        raise ModelError(name, f"no site '{actuator.target}'; the model has {among(actuator.target, sites)}")
    body = root_body(site.parent)
    if body in ("", "world"):
        raise ModelError(name, f"its site '{actuator.target}' is on no body that has a name; a thruster pushes a hull")
    return body


def root_body(body: mujoco.MjsBody) -> str:
    """Name of the body of the world that carries a body of a spec, or that it is."""
    while body.parent is not None and body.parent.name != "world":
        body = body.parent
    return body.name


def require_ctrlrange_alone(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator, name: str, what: str) -> None:
    """Refuse what MuJoCo would clip, or would not read, of an actuator whose activation is all that it does.

    Args:
        spec: of the model.
        actuator: a pump or a servo.
        name: of it.
        what: its activation, in words.

    Raises:
        ModelError: names the actuator.
    """
    if is_limited(spec, actuator.actlimited, actuator.actrange) and (
        actuator.actrange[0] > actuator.ctrlrange[0] or actuator.actrange[1] < actuator.ctrlrange[1]
    ):
        low, high = np.array(actuator.actrange).tolist()
        raise ModelError(name, f"has the actrange {low:g} {high:g} inside its ctrlrange, which alone limits {what}")
    gear = np.array(actuator.gear)
    if not np.isin(gear, [0.0, 1.0]).all():
        said = " ".join(f"{each:g}" for each in gear)
        raise ModelError(name, f'has gear "{said}", which nothing reads: leave it out; ctrlrange and dynprm say {what}')
    if is_limited(spec, actuator.forcelimited, actuator.forcerange):
        raise ModelError(name, f"has a forcerange, and no force; leave it out: ctrlrange and dynprm say {what}")


def is_limited(spec: mujoco.MjSpec, limited: mujoco.mjtLimited, bounds) -> bool:
    """Whether a range of an actuator holds, as MuJoCo's compiler sees it."""
    if limited == mujoco.mjtLimited.mjLIMITED_AUTO:
        return bool(spec.compiler.autolimits) and bool(np.any(np.array(bounds) != 0.0))
    return limited == mujoco.mjtLimited.mjLIMITED_TRUE


def _require_inside(name: str, attribute: str, bounds, needed, remedy: str) -> None:
    if not (bounds[0] <= needed[0] and needed[1] <= bounds[1]):
        raise ModelError(
            name,
            f"its {attribute} [{bounds[0]:g}, {bounds[1]:g}] cuts off its curve, which runs from {needed[0]:g} to "
            f"{needed[1]:g}; {remedy}",
        )
