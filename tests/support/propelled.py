"""Propellers on a hull for the tests, written a second time; shares nothing with cube_sim's laws."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from cube_sim.spatial import rotation_from_quaternion
from support.water_bodies import DENSITY, Body, fossen, values

REMUS = np.array([[0.0, 0.4566, 0.0700], [0.6632, 0.1798, 0.0312]])
"""J, K_T, K_Q of the propeller of REMUS 100, Wageningen B-series of three blades, area ratio 0.718 (T. I. Fossen,
Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., 2021, and B. Allen, W. Vorus and T. Prestero,
OCEANS 2000); 0.14 m, t = 0.1, w = 0.056."""
CURVED = np.array([[-0.5, 0.52, 0.075], [0.0, 0.45, 0.062], [0.4, 0.3, 0.045], [0.8, 0.1, 0.022], [1.0, -0.03, 0.004]])
ASTERN = np.array([[0.0, 0.3, 0.05], [0.5, 0.15, 0.03]])


@dataclass(frozen=True)
class Propeller:
    """One propeller; place and axis in body axes."""

    name: str
    place: np.ndarray
    axis: np.ndarray
    diameter: float = 0.14
    speeds: tuple[float, float] = (20.0, 25.0)
    ahead: np.ndarray | None = None
    astern: np.ndarray | None = None
    wake: tuple[float, float] = (0.056, 0.1)
    hand: float = 1.0
    lags: tuple[float, ...] = (0.1,)
    slowest: tuple[float, float] = (0.0, 0.0)

    def open_water(self, n: float, u_a: float) -> tuple[float, float]:
        """T and Q [N, N m]."""
        if n == 0.0:
            return 0.0, 0.0
        table = REMUS if self.ahead is None else self.ahead
        if n < 0.0 and self.astern is not None:
            table = self.astern
        J = u_a / (n * self.diameter)
        column = []
        for k in (1, 2):
            i = int(np.clip(np.searchsorted(table[:, 0], J) - 1, 0, len(table) - 2))
            slope = (table[i + 1, k] - table[i, k]) / (table[i + 1, 0] - table[i, 0])
            column.append(table[i, k] + slope * (J - table[i, 0]))
        scale = DENSITY * n * abs(n) * self.diameter**4
        return scale * column[0], scale * self.diameter * column[1]

    def rotation(self, state: float) -> float:
        n = state * (self.speeds[1] if state > 0.0 else self.speeds[0])
        return 0.0 if abs(n) < self.slowest[int(state > 0.0)] else n

    def wrench(self, nu_r: np.ndarray, state: float) -> np.ndarray:
        flow = float(self.axis @ (nu_r[:3] + np.cross(nu_r[3:], self.place)))
        thrust, torque = self.open_water(self.rotation(state), (1.0 - self.wake[0]) * flow)
        force = (1.0 - self.wake[1]) * thrust * self.axis
        return np.concatenate([force, np.cross(self.place, force) - self.hand * torque * self.axis])

    def rate(self, states: np.ndarray, command: float) -> np.ndarray:
        return (np.array([command, *states[:-1]]) - states) / np.array(self.lags)

    def numerics(self) -> dict[str, object]:
        given = {
            "diameter": [self.diameter],
            "speed": self.speeds,
            "open_water": REMUS if self.ahead is None else self.ahead,
            "wake": self.wake,
            "slowest": self.slowest,
        }
        if self.hand != 0.0:
            given["hand"] = [self.hand]
        if self.astern is not None:
            given["astern"] = self.astern
        return {f"{self.name}:propeller_{key}": value for key, value in given.items()}

    def site(self) -> str:
        return f'<site name="{self.name}" pos="{values(self.place)}" zaxis="{values(self.axis)}"/>'

    def actuator(self) -> str:
        kind = "filter" if len(self.lags) == 1 else "user"
        return (
            f'<general name="{self.name}" site="{self.name}" gear="0 0 1 0 0 0" dyntype="{kind}" '
            f'dynprm="{values(self.lags)}" gainprm="0" biastype="user"/>'
        )


@dataclass(frozen=True)
class Propelled:
    """A hull with propellers."""

    body: Body
    propellers: tuple[Propeller, ...]

    def rate(self, state: np.ndarray, commands: np.ndarray) -> np.ndarray:
        """d/dt of [p, q, nu, states of the rotors]."""
        pose, rest, total, rates = state[:13], state[13:], np.zeros(6), []
        R = rotation_from_quaternion(pose[3:7] / np.linalg.norm(pose[3:7]))
        nu_r = pose[7:] - np.concatenate([R.T @ self.body.current, np.zeros(3)])
        for each, command in zip(self.propellers, commands, strict=True):
            own, rest = rest[: len(each.lags)], rest[len(each.lags) :]
            total += each.wrench(nu_r, own[-1])
            rates.append(each.rate(own, command))
        return np.concatenate([fossen(self.body, pose, total), *rates])

    def reference(self, start: np.ndarray, steps: list[tuple[float, list[float]]], duration: float) -> np.ndarray:
        """The state after `duration`, the rotors at rest first, by DOP853; steps (time [s], commands)."""
        state = np.concatenate([start, np.zeros(sum(len(each.lags) for each in self.propellers))])
        for (begin, commands), (end, _) in pairwise([*steps, (duration, [])]):
            solved = solve_ivp(
                lambda _, y, c=commands: self.rate(y, np.array(c)),
                (begin, end), state, method="DOP853", rtol=1e-10, atol=1e-11,
            )  # fmt: skip
            state = solved.y[:, -1]
        return state

    def spec(self, timestep: float = 0.0025):
        """The model of it, an MjSpec."""
        numbers = {name: value for each in self.propellers for name, value in each.numerics().items()}
        numerics = "".join(f'<numeric name="{name}" data="{values(value)}"/>' for name, value in numbers.items())
        actuators = "".join(each.actuator() for each in self.propellers)
        extra = f"<custom>{numerics}</custom><actuator>{actuators}</actuator>"
        return self.body.spec("RK4", timestep, "".join(each.site() for each in self.propellers), extra)
