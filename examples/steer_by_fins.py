"""REMUS 100 flies by its propeller and its fins: a line with a change of depth, a helix, the lanes of a survey.

    python examples/steer_by_fins.py

Scenarios do it without a line of code (scenarios/remus100_*.yaml); this is an autopilot of one's own beside MuJoCo.
A fin has no force of its own: what it can do depends on the flow. So the autopilot asks for moments, and the fins'
effectiveness at the velocity of the moment makes deflections of them. The force of a fin is not asked for: it comes
along.
"""

from pathlib import Path

import mujoco
import numpy as np

import cube_sim
from cube_sim.vehicle.fins import Fins

MODEL = Path(__file__).parents[1] / "models" / "remus100.xml"
PERIOD_S = 0.1
AHEAD_M = 8.0  # how far ahead on its path it looks
ANGLE_PER_M, ANGLE_PER_M_S, STEEPEST = 0.1, 0.004, np.radians(25.0)  # pitch for an error of depth, and its integral
BALLASTED = 302.0 / (
    9.81 * 1030.0
)  # 3 N lighter than water; with the 9 N of the thesis it cannot hold its depth so slowly
INERTIA = 8.33  # I_yy - M_qdot = I_zz - N_rdot [kg m^2]
STIFFNESS, DAMPING, INTEGRAL = INERTIA * 1.0, INERTIA * 1.6, INERTIA * 0.15


class Autopilot:
    """Course and depth by moments about y and z, with an integral of the error of pitch and heading."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.fins = Fins.from_model(model)
        self._sum, self._climb = np.zeros(2), 0.0

    def deflections(self, data: mujoco.MjData, heading: float, height: float) -> np.ndarray:
        """(k,) angles for the servos [rad].

        Args:
            data: up to date.
            heading: wanted, from the world's x axis to the left [rad].
            height: z wanted [m].
        """
        R, rates = data.xmat[1].reshape(3, 3), data.qvel[3:6]
        nu = np.concatenate([R.T @ data.qvel[:3], rates])
        above = height - data.qpos[2]
        climb = np.clip(ANGLE_PER_M * above + self._climb, -STEEPEST, STEEPEST)
        if abs(climb) < STEEPEST:
            self._climb += ANGLE_PER_M_S * PERIOD_S * above
        off = np.array([climb - np.arcsin(R[2, 0]), heading - np.arctan2(R[1, 0], R[0, 0])])
        off[1] = np.arctan2(np.sin(off[1]), np.cos(off[1]))
        level = R[:, 1] @ [0.0, 0.0, 1.0]  # roll: what turns the hull in the world is not what turns it about its axes
        turn = np.array([-off[0] + level * off[1], off[1] + level * off[0]])
        self._sum = np.clip(self._sum + PERIOD_S * turn, -0.5, 0.5)
        moment = STIFFNESS * turn - DAMPING * rates[1:] + INTEGRAL * self._sum
        now = data.act[self.fins.activations]
        B = self.fins.effectiveness(now, nu)[4:]
        wanted = now + np.linalg.pinv(B, rcond=1e-6) @ (moment - self._made(now, nu))
        return np.clip(wanted, *self.fins.travel.T)

    def _made(self, now: np.ndarray, nu: np.ndarray) -> np.ndarray:
        """What the fins do by their deflection alone: their share in the hull's own stability is left to it."""
        return (self.fins.wrench(now, nu) - self.fins.wrench(np.zeros_like(now), nu))[4:]


class Line:
    """Along x, 3 m deeper from x = 60 m on."""

    start = (0.0, 2.0, -10.0)

    def at(self, position: np.ndarray) -> tuple[float, float, float]:
        """Heading [rad] and height [m] wanted, and the distance aside, to the left [m]."""
        return np.arctan2(-position[1], AHEAD_M), -10.0 if position[0] < 60.0 else -13.0, position[1]


class Helix:
    """To the left about the world's z axis, sinking by 6 m in a turn."""

    start, radius, pitch = (0.0, -20.0, -10.0), 20.0, 6.0

    def __init__(self) -> None:
        self.turned, self._before = 0.0, -0.5 * np.pi

    def at(self, position: np.ndarray) -> tuple[float, float, float]:
        """As for the line."""
        angle = np.arctan2(position[1], position[0])
        self.turned += np.angle(np.exp(1j * (angle - self._before)))
        self._before = angle
        aside = self.radius - np.hypot(position[0], position[1])
        height = self.start[2] - self.pitch * self.turned / (2.0 * np.pi)
        return angle + 0.5 * np.pi - np.arctan2(aside, AHEAD_M), height, aside


class Survey:
    """Lanes 25 m apart, at one depth; it turns to the next corner 6 m before it."""

    start = (0.0, 0.0, -10.0)
    corners = np.array([[0.0, 0.0], [80.0, 0.0], [80.0, 25.0], [0.0, 25.0], [0.0, 50.0], [80.0, 50.0]])

    def __init__(self) -> None:
        self.leg = 0

    def at(self, position: np.ndarray) -> tuple[float, float, float]:
        """As for the line."""
        if np.linalg.norm(self.corners[self.leg + 1] - position[:2]) < 6.0 and self.leg < len(self.corners) - 2:
            self.leg += 1
        begin, end = self.corners[self.leg : self.leg + 2]
        along = (end - begin) / np.linalg.norm(end - begin)
        aside = along[0] * (position[1] - begin[1]) - along[1] * (position[0] - begin[0])
        return np.arctan2(along[1], along[0]) - np.arctan2(aside, AHEAD_M), self.start[2], aside


def fly(path: Line | Helix | Survey, duration_s: float) -> np.ndarray:
    """(n,4) x [m], distance aside [m], error of depth [m] and speed ahead [m/s], ten times a second."""
    model = cube_sim.load_model(MODEL, {"hull:volume": BALLASTED})
    data, pilot = mujoco.MjData(model), Autopilot(model)
    data.qpos[:3], data.qvel[0], data.ctrl[0], data.act[0] = path.start, 1.4, 1.0, 1.0
    rows = []
    for _ in range(round(duration_s / PERIOD_S)):
        mujoco.mj_forward(model, data)
        heading, height, aside = path.at(data.qpos[:3])
        data.ctrl[pilot.fins.actuators] = pilot.deflections(data, heading, height)
        speed = float(data.xmat[1].reshape(3, 3)[:, 0] @ data.qvel[:3])
        rows.append([data.qpos[0], aside, data.qpos[2] - height, speed])
        mujoco.mj_step(model, data, nstep=round(PERIOD_S / model.opt.timestep))
    return np.array(rows)


def main() -> None:
    flown = fly(Line(), 130.0)
    aside, depth = np.abs(flown[-200:, 1:3]).max(axis=0)
    print(f"line:   {flown[-1, 0]:.0f} m, 3 m deeper, in the end {aside:.2f} m aside and {depth:.2f} m off its depth")

    helix = Helix()
    flown = fly(helix, 200.0)
    aside, depth = np.abs(flown[800:, 1:3]).max(axis=0)
    print(
        f"helix:  {helix.turned / (2.0 * np.pi):.1f} turns, at most {aside:.2f} m aside and {depth:.2f} m off its depth"
    )

    survey = Survey()
    flown = fly(survey, 220.0)
    middle = flown[np.abs(flown[:, 0] - 40.0) < 10.0]
    aside, depth = np.abs(middle[:, 1:3]).max(axis=0)
    print(
        f"survey: leg {survey.leg + 1} of {len(Survey.corners) - 1}, amidst its lanes at most {aside:.2f} m aside "
        f"and {depth:.2f} m off its depth"
    )


if __name__ == "__main__":
    main()
