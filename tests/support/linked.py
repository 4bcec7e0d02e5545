"""A hull with links in the water, and its motion written a second time.

Each body has its own twist V = [v; w] in its own axes, and Fossen's equations in it. Twists go outwards from the hull
through the joints, wrenches back inwards (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 5). It shares
nothing with cube_sim, which uses MuJoCo's world axes and the classical acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import cube_sim
from cube_sim.spatial import cross, skew
from support.water_bodies import DENSITY, GRAVITY, Body, coriolis_matrix, random_body, values


@dataclass(frozen=True)
class Link:
    """A body on the one before it.

    Attributes:
        body: its mass and water.
        parent: which body carries it; 0 is the hull.
        place: (3,) of its origin on that [m].
        attitude: (3,3) of it there, at joint position 0.
        axis: (3,) of its joint, its own axes.
        kind: "hinge", "slide" or "none".
        stiffness: of the joint [N m/rad, N/m], about position 0.
        friction: [N m s/rad, N s/m].
    """

    body: Body
    parent: int
    place: np.ndarray
    attitude: np.ndarray
    axis: np.ndarray
    kind: str = "hinge"
    stiffness: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Linked:
    """A hull and what it carries."""

    hull: Body
    links: tuple[Link, ...]
    gravity: float = GRAVITY
    names: tuple[str, ...] = field(default=("upper", "fore", "hand"))

    def text(self, timestep: float = 0.0025, integrator: str = "RK4") -> str:
        names = ("hull", *self.names)
        inside = dict.fromkeys(range(len(self.links) + 1), "")
        for k in range(len(self.links), 0, -1):
            link = self.links[k - 1]
            q = Rotation.from_matrix(link.attitude).as_quat(scalar_first=True)
            joint = (
                ""
                if link.kind == "none"
                else (
                    f'<joint name="{names[k]}" type="{link.kind}" axis="{values(link.axis)}" '
                    f'stiffness="{link.stiffness!r}" damping="{link.friction!r}"/>'
                )
            )
            inside[link.parent] = (
                f'<body name="{names[k]}" pos="{values(link.place)}" quat="{values(q)}">{joint}'
                f"{inertial(link.body)}{inside[k]}</body>{inside[link.parent]}"
            )
        numerics = "".join(
            body.numerics(name)
            for name, body in zip(names, [self.hull, *(each.body for each in self.links)], strict=False)
        )
        return f"""<mujoco><option timestep="{timestep!r}" integrator="{integrator}"
            gravity="0 0 {-self.gravity!r}" wind="{values(self.hull.current)}"><flag energy="enable" contact="disable"/>
            </option><custom><numeric name="water:density" data="{DENSITY}"/>{numerics}</custom>
            <worldbody><body name="hull"><freejoint name="hull"/>{inertial(self.hull)}{inside[0]}</body></worldbody>
            </mujoco>"""

    def model(self, timestep: float = 0.0025, integrator: str = "RK4", parameters=None) -> mujoco.MjModel:
        return cube_sim.load_model(mujoco.MjSpec.from_string(self.text(timestep, integrator)), parameters)

    @property
    def moving(self) -> list[int]:
        """Numbers of the links that have a joint."""
        return [k for k, link in enumerate(self.links, 1) if link.kind != "none"]

    def rates(self, t: float, state: np.ndarray) -> np.ndarray:
        """d/dt of [p, q (7), joint positions, V of the hull (6), joint velocities]."""
        n = len(self.moving)
        pose, angles, V0, speeds = state[:7], state[7 : 7 + n], state[7 + n : 13 + n], state[13 + n :]
        q = pose[3:] / np.linalg.norm(pose[3:])
        R0 = Rotation.from_quat(q, scalar_first=True).as_matrix()
        bodies = [self.hull, *(link.body for link in self.links)]
        R, V, bias, J = [R0], [V0], [np.zeros(6)], [np.hstack([np.eye(6), np.zeros((6, n))])]
        column = 0
        stiff = np.zeros(6 + n)
        for link in self.links:
            rotation, place, S, angle, speed = link.attitude, link.place, np.zeros(6), 0.0, 0.0
            if link.kind != "none":
                angle, speed = angles[column], speeds[column]
                axis = link.axis / np.linalg.norm(link.axis)
                if link.kind == "hinge":
                    rotation, S = (
                        rotation @ Rotation.from_rotvec(angle * axis).as_matrix(),
                        np.append(np.zeros(3), axis),
                    )
                else:
                    place, S = place + rotation @ (angle * axis), np.append(axis, np.zeros(3))
            X = inward(rotation, place)
            own = X @ V[link.parent] + S * speed
            V.append(own)
            bias.append(X @ bias[link.parent] + motion_cross(own, S * speed))
            jacobian = X @ J[link.parent]
            if link.kind != "none":
                jacobian[:, 6 + column] += S
                stiff[6 + column] = -link.stiffness * angle - link.friction * speed
                column += 1
            J.append(jacobian)
            R.append(R[link.parent] @ rotation)
        M, force = np.zeros((6 + n, 6 + n)), stiff
        for body, Rb, Vb, bb, Jb in zip(bodies, R, V, bias, J, strict=True):
            v_c = Rb.T @ np.asarray(self.hull.current)
            V_r = Vb - np.append(v_c, np.zeros(3))
            turn = np.append(-cross(Vb[3:], v_c), np.zeros(3))  # d/dt of the current in turning axes
            up = Rb.T @ np.array([0.0, 0.0, 1.0])
            W, B = body.mass * self.gravity * up, DENSITY * body.volume * self.gravity * up
            F = (
                -coriolis_matrix(body.rigid, Vb) @ Vb
                - coriolis_matrix(body.added, V_r) @ V_r
                - body.linear @ V_r
                - body.quadratic @ (np.abs(V_r) * V_r)
                + body.added @ turn
                + np.append(B - W, cross(body.cb, B) - cross(body.cg, W))
            )
            M += Jb.T @ (body.rigid + body.added) @ Jb
            force = force + Jb.T @ (F - (body.rigid + body.added) @ bb)
        w = V0[3:]
        q_dot = 0.5 * np.array(
            [
                -w @ q[1:],
                *(q[0] * w + cross(q[1:], w)),
            ]
        )
        return np.concatenate([R0 @ V0[:3], q_dot, speeds, np.linalg.solve(M, force)])

    def reference(self, start: np.ndarray, duration: float) -> np.ndarray:
        """The state after `duration` by DOP853."""
        return solve_ivp(self.rates, (0.0, duration), start, method="DOP853", rtol=1e-10, atol=1e-11).y[:, -1]

    def set_state(self, data: mujoco.MjData, state: np.ndarray) -> None:
        n = len(self.moving)
        data.qpos[:] = state[: 7 + n]
        R = Rotation.from_quat(state[3:7], scalar_first=True).as_matrix()
        data.qvel[:] = np.concatenate([R @ state[7 + n : 10 + n], state[10 + n :]])

    def get_state(self, data: mujoco.MjData) -> np.ndarray:
        R = Rotation.from_quat(data.qpos[3:7], scalar_first=True).as_matrix()
        return np.concatenate([data.qpos, R.T @ data.qvel[:3], data.qvel[3:]])

    def flown(self, model: mujoco.MjModel, start: np.ndarray, duration: float) -> np.ndarray:
        """The state after `duration` by MuJoCo."""
        data = mujoco.MjData(model)
        self.set_state(data, start)
        mujoco.mj_step(model, data, nstep=round(duration / model.opt.timestep))
        return self.get_state(data)


def inertial(body: Body) -> str:
    I = body.inertia_at_cg  # noqa: E741
    full = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
    return f'<inertial pos="{values(body.cg)}" mass="{body.mass!r}" fullinertia="{values(full)}"/>'


def inward(rotation: np.ndarray, place: np.ndarray) -> np.ndarray:
    """X (6,6): the twist of a body at `place` on another, from that one's; both in their own axes."""
    X = np.zeros((6, 6))
    X[:3, :3] = X[3:, 3:] = rotation.T
    X[:3, 3:] = -rotation.T @ skew(place)
    return X


def motion_cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of two twists [v; w]."""
    return np.append(cross(a[3:], b[:3]) + cross(a[:3], b[3:]), cross(a[3:], b[3:]))


def random_link(rng: np.random.Generator, parent: int, kind: str = "hinge", damped: bool = True) -> Link:
    """A tenth of a hull, with full matrices."""
    whole = random_body(rng, 1.5)
    share = 0.12
    body = Body(
        mass=share * whole.mass,
        cg=whole.cg,
        inertia_at_cg=share * whole.inertia_at_cg,
        volume=share * whole.volume,
        cb=whole.cb,
        added=share * whole.added,
        linear=share * whole.linear if damped else np.zeros((6, 6)),
        quadratic=share * whole.quadratic if damped else np.zeros((6, 6)),
    )
    return Link(
        body=body,
        parent=parent,
        place=rng.uniform(-0.4, 0.4, 3),
        attitude=Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix(),
        axis=rng.normal(size=3),
        kind=kind,
    )


def random_start(rng: np.random.Generator, joints: int) -> np.ndarray:
    q = rng.normal(size=4)
    return np.concatenate(
        [
            rng.normal(size=3),
            q / np.linalg.norm(q),
            rng.uniform(-0.3, 0.3, joints),
            rng.uniform(-0.4, 0.4, 3),
            rng.uniform(-0.6, 0.6, 3),
            rng.uniform(-1.0, 1.0, joints),
        ]
    )
