"""A hull read back from the compiled model: the numbers a controller, an allocator or an analysis starts from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.spatial import skew
from cube_sim.vehicle.ballast import Ballast
from cube_sim.vehicle.carried_water import carried_water, link_records
from cube_sim.vehicle.fins import Fins
from cube_sim.vehicle.lift import HullLift
from cube_sim.vehicle.mjcf.thruster_elements import require_fixed_thrusters
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.thrusters import Thrusters
from cube_sim.vehicle.unread import warn_of_unread

if TYPE_CHECKING:
    from cube_sim.vehicle.dynamics import Dynamics


@dataclass(frozen=True)
class Vehicle:
    """One hull of a water model; matrices are in body axes at the body origin.

    What it carries is in all of them as it stands at the reference pose, or at that asked for, the water on links too.

    Attributes:
        name: the body's name.
        body: its index in the model.
        qpos_address: where its pose (position, quaternion wxyz) starts in qpos.
        dof_address: where its velocity starts in qvel.
        mass_matrix: rigid-body mass M_RB (6,6) [kg, kg m, kg m^2].
        added_mass: M_A (6,6) [kg, kg m, kg m^2].
        linear_damping: D (6,6) [N s/m, N s, N m s].
        quadratic_damping: D_q (6,6) [N s^2/m^2, ...], acting on |nu_r| nu_r; that of links is
            exact for motion along, or about, one axis.
        displaced_mass: rho V [kg].
        centre_of_mass: r_CG (3,) [m].
        centre_of_buoyancy: r_CB (3,) [m].
        gravity: (3,) world axes [m/s^2].
        actuation_matrix: A (6,m) [1, m], F_B = A F_m, read from the compiled transmission.
        thrusters: names, indices, limits, characteristics, pulses and power of the m thrusters.
        fins: the k fins that servos turn; None for none.
        lift: what the flow lifts of the hull; None for nothing.
        ballast: what is pumped to make it lighter or heavier; None for none.
    """

    name: str
    body: int
    qpos_address: int
    dof_address: int
    mass_matrix: NDArray[np.float64]
    added_mass: NDArray[np.float64]
    linear_damping: NDArray[np.float64]
    quadratic_damping: NDArray[np.float64]
    displaced_mass: float
    centre_of_mass: NDArray[np.float64]
    centre_of_buoyancy: NDArray[np.float64]
    gravity: NDArray[np.float64]
    actuation_matrix: NDArray[np.float64]
    thrusters: Thrusters
    fins: Fins | None = None
    lift: HullLift | None = None
    ballast: Ballast | None = None

    @property
    def mass(self) -> float:
        """Rigid-body mass [kg]."""
        return float(self.mass_matrix[0, 0])

    @property
    def lag_s(self) -> NDArray[np.float64]:
        """(m + k,) time constants of motors and servos [s]."""
        return self.thrusters.lag_s if self.fins is None else np.append(self.thrusters.lag_s, self.fins.lag_s)

    @property
    def dynamics(self) -> Dynamics:
        """The equations of motion with these numbers: what a controller knows when it knows the vehicle exactly."""
        from cube_sim.vehicle.dynamics import Dynamics  # only here: it loads the compiler

        dynamics = Dynamics(
            mass_matrix=self.mass_matrix,
            added_mass=self.added_mass,
            linear_damping=self.linear_damping,
            quadratic_damping=self.quadratic_damping,
            displaced_mass=self.displaced_mass,
            centre_of_mass=self.centre_of_mass,
            centre_of_buoyancy=self.centre_of_buoyancy,
            gravity=self.gravity,
        )
        return dynamics if self.lift is None else self.lift.known_as(dynamics)

    @staticmethod
    def from_model(model: mujoco.MjModel, name: str | None = None, qpos: NDArray[np.float64] | None = None) -> Vehicle:
        """Read a hull from a model made by `load_model`.

        Args:
            model: the compiled model.
            name: which hull; may be left out when there is only one.
            qpos: (nq,) where its joints stand; left out, the reference pose.

        Raises:
            ModelError: the model has no water, or no such hull, or several and no name was given, or
                a joint moves one of its thrusters against it.
        """
        packed = packing.packed_parameters(model).copy()
        records = _hull_records(packed)
        names = {model.body(int(record[layout.BODY])).name: record for record in records}
        if name is None and len(names) > 1:
            raise ModelError("", f"the model has several hulls, name one of {', '.join(names)}")
        chosen = next(iter(names)) if name is None else name
        if chosen not in names:
            raise ModelError(chosen, f"is no hull; the model has {among(chosen, names)}")
        require_fixed_thrusters(model, int(names[chosen][layout.BODY]))
        links = link_records(model, packed, int(names[chosen][layout.BODY]))
        warn_of_unread(model, chosen, names[chosen])
        for link in links:
            warn_of_unread(model, model.body(int(link[layout.BODY])).name, link)
        pose = model.qpos0 if qpos is None else qpos
        return _vehicle(model, names[chosen], links, chosen, list(names).index(chosen), pose)


def hull_names(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the hulls of a model made by `load_model`.

    Raises:
        ModelError: the model has no water.
    """
    return tuple(
        model.body(int(record[layout.BODY])).name for record in _hull_records(packing.packed_parameters(model))
    )


def _hull_records(packed: NDArray[np.float64]) -> NDArray[np.float64]:
    start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
    return packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)


def _vehicle(
    model: mujoco.MjModel,
    record: NDArray[np.float64],
    links: NDArray[np.float64],
    name: str,
    number: int,
    qpos: NDArray[np.float64],
) -> Vehicle:
    body, dof = int(record[layout.BODY]), int(record[layout.DOF])
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    mujoco.mj_forward(model, data)
    mass_matrix, centre_of_mass = _rigid_body(model, data, body)
    thrusters = Thrusters.from_model(model, body)
    R = data.xmat[body].reshape(3, 3)
    moment = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    joint_axes = moment[thrusters.actuators, dof : dof + 6].T
    water = carried_water(data, record, links)
    fins, ballast = Fins.from_model(model, number), Ballast.from_model(model, number)
    return Vehicle(
        name=name,
        body=body,
        qpos_address=int(model.jnt_qposadr[model.body_jntadr[body]]),
        dof_address=dof,
        mass_matrix=mass_matrix,
        added_mass=water.added_mass,
        linear_damping=water.linear_damping,
        quadratic_damping=water.quadratic_damping,
        displaced_mass=water.displaced_mass,
        centre_of_mass=centre_of_mass,
        centre_of_buoyancy=water.centre_of_buoyancy,
        gravity=np.array(model.opt.gravity),
        actuation_matrix=np.vstack([R.T @ joint_axes[:3], joint_axes[3:]]),
        thrusters=thrusters,
        fins=fins if fins.names else None,
        lift=HullLift.from_model(model, number, water.added_mass, water.added_mass_of_links),
        ballast=ballast if ballast.names else None,
    )


def _rigid_body(
    model: mujoco.MjModel, data: mujoco.MjData, hull: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """M_RB about the hull's origin in its axes, and the centre of mass, of the hull with everything on it."""
    R, p = data.xmat[hull].reshape(3, 3), data.xpos[hull]
    total = np.zeros((6, 6))
    for body in range(hull, model.nbody):
        if model.body_rootid[body] != model.body_rootid[hull]:
            continue
        m = model.body_mass[body]
        S = skew(R.T @ (data.xipos[body] - p))
        axes = R.T @ data.ximat[body].reshape(3, 3)
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        total += np.block([[m * np.eye(3), -m * S], [m * S, inertia - m * S @ S]])
    first_moment = np.array([total[5, 1], total[3, 2], total[4, 0]])
    return total, first_moment / total[0, 0]
