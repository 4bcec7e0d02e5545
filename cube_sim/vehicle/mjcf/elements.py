"""Values of the MJCF's own elements that may be given in place of the file's, as the water's numbers may.

    <hull>:mass              [kg]
    <hull>:centre_of_mass    [m], body axes
    <hull>:inertia           3 values along the axes of its <inertial>, or 6 as MJCF's fullinertia has them (xx, yy, zz,
                             xy, xz, yz; body axes), about the centre of mass [kg m^2]
    <hull>:thruster_lag      time constant of each of its thrusters [s]
    <thruster>:thruster_lag  of one, before its hull's

The file says them in its elements: there a numeric of such a name is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.mjcf.thruster_elements import ThrusterElement, carrier, is_thruster

MASS, CENTRE_OF_MASS, INERTIA, LAG = "mass", "centre_of_mass", "inertia", "thruster_lag"
ELEMENT_PARAMETERS = (MASS, CENTRE_OF_MASS, INERTIA, LAG)
_SIZES = {MASS: (1,), CENTRE_OF_MASS: (3,), INERTIA: (3, 6), LAG: (1,)}
_FROM_GEOMS = 1  # compiler inertiafromgeom="true"

Values = Mapping[str, NDArray[np.float64]]


def is_of_element(name: str) -> bool:
    """Whether a parameter is one of these."""
    return name.rpartition(":")[2] in ELEMENT_PARAMETERS


def set_elements(
    spec: mujoco.MjSpec, values: Values, bodies: Sequence[str], thrusters: Sequence[ThrusterElement | None]
) -> None:
    """Give elements of a spec other values.

    Args:
        spec: changed here.
        values: name -> values (n,).
        bodies: names of the hulls and of all they carry.
        thrusters: one entry per actuator; None for one that is no thruster.

    Raises:
        ModelError: names the parameter at fault and says what would be right.
    """
    for name in sorted(values, key=lambda each: each.rpartition(":")[0] not in bodies):  # a thruster's own comes last
        owner, _, parameter = name.rpartition(":")
        given = values[name]
        require_possible(name, given)
        if parameter == LAG:
            _set_lag(spec, name, owner, float(given[0]), thrusters)
        elif owner not in bodies:
            raise ModelError(name, f"no body '{owner}'; the model has {among(owner, bodies)}")
        else:
            _set_inertial(spec, name, spec.body(owner), given)


def require_possible(name: str, given: NDArray[np.float64]) -> None:
    """Refuse values (n,) of such a parameter that no hull or thruster has.

    Raises:
        ModelError: says what would be right.
    """
    parameter = name.rpartition(":")[2]
    if given.ndim != 1 or given.shape[0] not in _SIZES[parameter] or not np.isfinite(given).all():
        right = " or ".join(map(str, _SIZES[parameter]))
        raise ModelError(name, f"is {given.tolist()!r:.80}; {right} finite numbers are right")
    if parameter in (MASS, LAG) and given[0] <= 0.0:
        raise ModelError(
            name, f"is {given[0]:g}; a {'mass [kg]' if parameter == MASS else 'time constant [s]'} is positive"
        )
    if parameter == INERTIA:
        xx, yy, zz, xy, xz, yz = [*given, *np.zeros(6 - given.size)]
        moments = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        # No distribution of mass has more about one axis than about the other two together.
        if moments[0] <= 0.0 or moments[2] > (1.0 + 1e-9) * (moments[0] + moments[1]):
            told = " ".join(f"{moment:g}" for moment in moments)
            raise ModelError(name, f"has the principal moments {told}; positive, none above the others' sum, is right")


def lags_of(model: mujoco.MjModel, owner: str) -> dict[str, float]:
    """Name of each thruster that is, or is on, an element of that name -> its time constant [s]."""
    return {model.actuator(i).name: float(model.actuator_dynprm[i, 0]) for i in _lagging(model, owner)}


def _lagging(model: mujoco.MjModel, owner: str) -> list[int]:
    """Indices of these thrusters."""
    itself = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, owner)
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, owner)
    return [i for i in range(model.nu) if is_thruster(model, i) and (i == itself or carrier(model, i) == body)]


def element_values(model: mujoco.MjModel, name: str) -> NDArray[np.float64] | None:
    """What a compiled model has of such a parameter (n,), a lag for each thruster; None where nothing has its name."""
    owner, _, parameter = name.rpartition(":")
    if parameter == LAG:
        lagging = _lagging(model, owner)
        return model.actuator_dynprm[lagging, 0] if lagging else None
    if parameter not in ELEMENT_PARAMETERS or mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, owner) < 0:
        return None
    body = model.body(owner)
    if parameter == INERTIA and not np.array_equal(body.iquat, [1.0, 0.0, 0.0, 0.0]):
        axes = np.zeros(9)
        mujoco.mju_quat2Mat(axes, body.iquat)
        turned = axes.reshape(3, 3) @ np.diag(body.inertia) @ axes.reshape(3, 3).T
        return turned[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return np.array({MASS: body.mass, CENTRE_OF_MASS: body.ipos, INERTIA: body.inertia}[parameter])


def set_compiled_element(model: mujoco.MjModel, name: str, given: NDArray[np.float64]) -> None:
    """Give an element of a compiled model another value; what follows from it is for `mj_setConst`.

    Args:
        model: changed here.
        name: of a parameter that `element_values` has.
        given: values (n,), as `require_possible` lets them pass.

    Raises:
        ModelError: three moments of inertia for a hull whose axes are not the body's.
    """
    owner, _, parameter = name.rpartition(":")
    if parameter == LAG:
        model.actuator_dynprm[_lagging(model, owner), 0] = given[0]
        return
    body = model.body(owner)
    if parameter == MASS:
        body.mass[:] = given
    elif parameter == CENTRE_OF_MASS:
        body.ipos[:] = given
    elif given.size == 3:
        if not np.array_equal(body.iquat, [1.0, 0.0, 0.0, 0.0]):
            raise ModelError(name, "has 3 values, and the axes of inertia are not the body's; give 6")
        body.inertia[:] = given
    else:
        body.inertia[:], body.iquat[:] = _principal(given)


def _principal(full: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal moments (3,) and the quaternion (4,) of their axes, to the bit as MuJoCo's compiler has them."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(mass=1.0, explicitinertial=True, ipos=np.zeros(3))
    body.fullinertia = full
    body.add_freejoint()
    model = spec.compile()
    return model.body_inertia[1], model.body_iquat[1]


def _set_lag(
    spec: mujoco.MjSpec, name: str, owner: str, lag: float, thrusters: Sequence[ThrusterElement | None]
) -> None:
    meant = [i for i, each in enumerate(thrusters) if each is not None and owner in (each.name, each.body)]
    if not meant:
        raise ModelError(name, f"'{owner}' is no thruster, and no hull that has one")
    for i in meant:
        spec.actuators[i].dynprm[0] = lag  # every thruster has one


def _set_inertial(spec: mujoco.MjSpec, name: str, body: mujoco.MjsBody, given: NDArray[np.float64]) -> None:
    if not body.explicitinertial or spec.compiler.inertiafromgeom == _FROM_GEOMS:
        raise ModelError(name, "follows from the geoms of this body; give it an <inertial> in the MJCF")
    parameter = name.rpartition(":")[2]
    if parameter == MASS:
        body.mass = float(given[0])
    elif parameter == CENTRE_OF_MASS:
        body.ipos = given
    elif given.size == 3 and not np.isfinite(body.fullinertia).all():
        body.inertia = given
    else:
        full = np.concatenate([given, np.zeros(6 - given.size)])
        body.fullinertia, body.iquat, body.inertia = full, [1.0, 0.0, 0.0, 0.0], np.zeros(3)
