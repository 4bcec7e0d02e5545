"""Bodies in water for the tests: random ones with every coupling, and their motion written a second time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import mujoco
import numpy as np
from scipy.integrate import solve_ivp

import cube_sim
from cube_sim.spatial import rotation_from_quaternion, skew

GRAVITY = 9.81
DENSITY = 1000.0


@dataclass(frozen=True)
class Body:
    """A rigid body and its water; everything about the body origin, in body axes."""

    mass: float = 10.0
    cg: np.ndarray = field(default_factory=lambda: np.zeros(3))
    inertia_at_cg: np.ndarray = field(default_factory=lambda: np.diag([0.5, 0.6, 0.7]))
    volume: float = 0.01
    cb: np.ndarray = field(default_factory=lambda: np.zeros(3))
    added: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))
    linear: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))
    quadratic: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))
    current: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def rigid(self) -> np.ndarray:
        """M_RB (6,6) about the origin (Fossen 2011, eq. 3.44)."""
        S = skew(self.cg)
        m = self.mass
        return np.block([[m * np.eye(3), -m * S], [m * S, self.inertia_at_cg - m * S @ S]])

    def neutral(self) -> Body:
        """The same, weighing nothing in the water and without a righting moment."""
        return replace(self, volume=self.mass / DENSITY, cb=self.cg)

    def ideal(self) -> Body:
        """The same in water at rest that takes no energy."""
        return replace(self, linear=np.zeros((6, 6)), quadratic=np.zeros((6, 6)), current=(0.0, 0.0, 0.0))

    def numerics(self, name: str) -> str:
        rows = {
            "volume": np.array([self.volume]),
            "centre_of_buoyancy": self.cb,
            "added_mass": self.added,
            "linear_damping": self.linear,
            "quadratic_damping": self.quadratic,
        }
        return "\n".join(f'<numeric name="{name}:{key}" data="{values(value)}"/>' for key, value in rows.items())

    def element(self, name: str, position=(0.0, 0.0, 0.0), inside: str = "") -> str:
        I = self.inertia_at_cg  # noqa: E741
        full = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
        return f"""<body name="{name}" pos="{values(position)}"><freejoint name="{name}"/>
            <inertial pos="{values(self.cg)}" mass="{self.mass!r}" fullinertia="{values(full)}"/>{inside}</body>"""

    def model(self, integrator: str = "RK4", timestep: float = 0.005, inside: str = "", extra: str = ""):
        return cube_sim.load_model(self.spec(integrator, timestep, inside, extra))

    def spec(self, integrator: str = "RK4", timestep: float = 0.005, inside: str = "", extra: str = ""):
        return mujoco.MjSpec.from_string(
            scene([(self, "hull", (0.0, 0.0, 0.0))], integrator, timestep, self.current, inside, extra)
        )


def values(array) -> str:
    return " ".join(repr(float(x)) for x in np.asarray(array, dtype=float).ravel())


def scene(bodies, integrator="RK4", timestep=0.005, current=(0.0, 0.0, 0.0), inside="", extra="") -> str:
    """MJCF of several (body, name, position)."""
    return f"""<mujoco>
        <option timestep="{float(timestep)!r}" integrator="{integrator}"
            gravity="0 0 {-GRAVITY}" wind="{values(current)}"/>
        <custom><numeric name="water:density" data="{DENSITY}"/>
        {"".join(body.numerics(name) for body, name, _ in bodies)}</custom>
        <worldbody>{"".join(body.element(name, position, inside) for body, name, position in bodies)}</worldbody>
        {extra}</mujoco>"""


def random_body(rng: np.random.Generator, added_over_rigid: float = 3.0) -> Body:
    """Full symmetric added mass, full damping, offset CG and CB, a current.

    Args:
        rng: source of randomness.
        added_over_rigid: the largest eigenvalue of M_RB^-1 M_A.
    """
    lengths = rng.uniform(0.3, 0.9, 3)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    mass = rng.uniform(8.0, 20.0)
    moments = mass / 12.0 * (lengths @ lengths - lengths**2)
    body = Body(
        mass=mass,
        cg=rng.uniform(-0.08, 0.08, 3),
        inertia_at_cg=axes @ np.diag(moments) @ axes.T,
        volume=mass / DENSITY * rng.uniform(0.97, 1.03),
        cb=rng.uniform(-0.08, 0.08, 3),
        linear=positive(rng, 6) * np.outer(SCALE, SCALE) * 4.0,
        quadratic=np.diag(rng.uniform(2.0, 6.0, 6) * SCALE**2) + 0.3 * rng.normal(size=(6, 6)) * np.outer(SCALE, SCALE),
        current=tuple(rng.uniform(-0.3, 0.3, 3)),
    )
    added = positive(rng, 6) * np.outer(SCALE, SCALE)
    largest = np.linalg.eigvals(np.linalg.solve(body.rigid, added)).real.max()
    return replace(body, added=added * added_over_rigid / largest)


SCALE = np.array([1.0, 1.0, 1.0, 0.3, 0.3, 0.3])


def positive(rng: np.random.Generator, n: int) -> np.ndarray:
    """A full symmetric positive definite matrix with eigenvalues in [0.2, 2]."""
    Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    return Q @ np.diag(rng.uniform(0.2, 2.0, n)) @ Q.T


def coriolis_matrix(M: np.ndarray, nu: np.ndarray) -> np.ndarray:
    """C(nu) (6,6) of Fossen 2011, theorem 3.2, as blocks of skew matrices."""
    p, h = M[:3] @ nu, M[3:] @ nu
    C = np.zeros((6, 6))
    C[:3, 3:] = C[3:, :3] = -skew(p)
    C[3:, 3:] = -skew(h)
    return C


def fossen(body: Body, state: np.ndarray, wrench: np.ndarray | None = None) -> np.ndarray:
    """d/dt [p_WB, q_WB, nu] by Fossen's model in relative velocity; shares nothing with cube_sim's law."""
    q, nu = state[3:7] / np.linalg.norm(state[3:7]), state[7:]
    R = rotation_from_quaternion(q)
    w = nu[3:]
    v_c = R.T @ np.asarray(body.current)
    nu_c = np.concatenate([v_c, np.zeros(3)])
    nu_c_dot = np.concatenate([-skew(w) @ v_c, np.zeros(3)])
    nu_r = nu - nu_c
    up = R.T @ np.array([0.0, 0.0, 1.0])
    W, B = body.mass * GRAVITY * up, DENSITY * body.volume * GRAVITY * up
    restoring = np.concatenate([W - B, skew(body.cg) @ W - skew(body.cb) @ B])
    right = (
        -coriolis_matrix(body.rigid, nu) @ nu
        - coriolis_matrix(body.added, nu_r) @ nu_r
        - body.linear @ nu_r
        - body.quadratic @ (np.abs(nu_r) * nu_r)
        - restoring
        + body.added @ nu_c_dot
    )
    if wrench is not None:
        right = right + wrench
    nu_dot = np.linalg.solve(body.rigid + body.added, right)
    omega = np.block([[np.zeros((1, 1)), -w[None]], [w[:, None], -skew(w)]])
    return np.concatenate([R @ nu[:3], 0.5 * omega @ q, nu_dot])


def reference(body: Body, start: np.ndarray, duration: float, wrench: np.ndarray | None = None) -> np.ndarray:
    """The state after `duration` by DOP853 at relative tolerance 1e-12."""
    solution = solve_ivp(
        lambda _, y: fossen(body, y, wrench), (0.0, duration), start, method="DOP853", rtol=1e-12, atol=1e-13
    )
    return solution.y[:, -1]


def set_state(data: mujoco.MjData, state: np.ndarray) -> None:
    """[p, q, nu] into the first free joint: MuJoCo keeps linear velocity in world axes."""
    data.qpos[:7] = state[:7]
    data.qvel[:3] = rotation_from_quaternion(state[3:7]) @ state[7:10]
    data.qvel[3:6] = state[10:]


def get_state(data: mujoco.MjData) -> np.ndarray:
    q = np.array(data.qpos[3:7])
    return np.concatenate([data.qpos[:7], rotation_from_quaternion(q).T @ data.qvel[:3], data.qvel[3:6]])


def flown(model: mujoco.MjModel, start: np.ndarray, duration: float) -> np.ndarray:
    """The state after `duration` by MuJoCo."""
    data = mujoco.MjData(model)
    set_state(data, start)
    mujoco.mj_step(model, data, nstep=round(duration / model.opt.timestep))
    return get_state(data)


def tumbling(rng: np.random.Generator) -> np.ndarray:
    q = rng.normal(size=4)
    return np.concatenate(
        [rng.normal(size=3), q / np.linalg.norm(q), rng.uniform(-0.8, 0.8, 3), rng.uniform(-1.5, 1.5, 3)]
    )
