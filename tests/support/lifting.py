"""Lift of fins and hulls for the tests, written a second time; shares nothing with cube_sim's laws."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from cube_sim.spatial import rotation_from_quaternion
from support.water_bodies import DENSITY, Body, coriolis_matrix, fossen, values


@dataclass(frozen=True)
class Fin:
    """One fin; place and axes (chord, normal) in body axes."""

    name: str
    place: np.ndarray
    chord: np.ndarray
    normal: np.ndarray
    area: float
    slope: float
    stall: float | None = None
    drag: tuple[float, float] = (0.01, 0.9)
    aspect: float = 3.0
    servo: tuple[float, float] | None = None  # lag, rate

    def force(self, nu_r: np.ndarray, angle: float) -> np.ndarray:
        """The force [N], body axes."""
        flow = nu_r[:3] + np.cross(nu_r[3:], self.place)
        u, n = self.chord @ flow, self.normal @ flow
        pressure = 0.5 * DENSITY * self.area
        if self.stall is None:
            return pressure * self.slope * abs(u) * (u * angle - n) * self.normal
        attack = np.angle(np.exp(1j * angle) * (u - 1j * n))
        share = 1.0 / ((1.0 + np.exp(50.0 * (attack - self.stall))) * (1.0 + np.exp(-50.0 * (attack + self.stall))))
        plate = 2.0 * np.sin(attack) ** 2
        C_L = share * self.slope * attack + (1.0 - share) * np.sign(attack) * plate * np.cos(attack)
        induced = (self.slope * attack) ** 2 / (np.pi * self.drag[1] * self.aspect)
        C_D = self.drag[0] + share * induced + (1.0 - share) * plate * abs(np.sin(attack))
        ahead = u * self.chord + n * self.normal
        aside = u * self.normal - n * self.chord
        return pressure * np.hypot(u, n) * (C_L * aside - C_D * ahead)

    def numerics(self) -> str:
        rows = {"area": [self.area], "lift_slope": [self.slope]}
        if self.stall is not None:
            rows |= {"stall": [self.stall], "drag": self.drag, "aspect_ratio": [self.aspect]}
        return "".join(f'<numeric name="{self.name}:fin_{key}" data="{values(x)}"/>' for key, x in rows.items())

    def site(self) -> str:
        across = np.cross(self.normal, self.chord)
        return f'<site name="{self.name}" pos="{values(self.place)}" xyaxes="{values([*self.chord, *across])}"/>'

    def actuator(self) -> str:
        if self.servo is None:
            return ""
        return (
            f'<general name="{self.name}" site="{self.name}" dyntype="user" dynprm="{values(self.servo)}" gainprm="0" '
            'ctrllimited="true" ctrlrange="-0.5 0.5"/>'
        )


@dataclass(frozen=True)
class Lifted:
    """A hull with fins, products of velocities (axis, j, k, c) and strips (x, breadth, height)."""

    body: Body
    fins: tuple[Fin, ...] = ()
    products: tuple[tuple[int, int, int, float], ...] = ()
    stations: np.ndarray | None = None
    cross_flow: tuple[float, float] = (1.1, 0.7)
    coriolis: bool = True

    def wrench(self, nu_r: np.ndarray, angles: list[float]) -> np.ndarray:
        total = np.zeros(6)
        for fin, angle in zip(self.fins, angles, strict=True):
            force = fin.force(nu_r, angle)
            total += np.concatenate([force, np.cross(fin.place, force)])
        for axis, j, k, c in self.products:
            second = nu_r[k - 1] if k > 0 else abs(nu_r[-k - 1])
            total[axis - 1] += c * nu_r[j - 1] * second
        if not self.coriolis:
            total += coriolis_matrix(self.body.added, nu_r) @ nu_r
        if self.stations is not None:
            x, breadth, height = self.stations.T
            v, w = nu_r[1] + x * nu_r[5], nu_r[2] - x * nu_r[4]
            pressed = 0.5 * DENSITY * (self.cross_flow[0] * height * v**2 + self.cross_flow[1] * breadth * w**2)
            y, z = -pressed * v / np.hypot(v, w), -pressed * w / np.hypot(v, w)
            total[[1, 2, 4, 5]] += [np.trapezoid(f, x) for f in (y, z, -x * z, x * y)]
        return total

    def rate(self, state: np.ndarray, targets: np.ndarray) -> np.ndarray:
        """d/dt of [p, q, nu, deflections of the fins that have a servo]."""
        pose, turned = state[:13], state[13:]
        R = rotation_from_quaternion(pose[3:7] / np.linalg.norm(pose[3:7]))
        nu_r = pose[7:] - np.concatenate([R.T @ self.body.current, np.zeros(3)])
        waiting = iter(turned)
        angles = [next(waiting) if fin.servo else 0.0 for fin in self.fins]
        moved = [
            np.clip((target - angle) / fin.servo[0], -fin.servo[1], fin.servo[1])
            for fin, angle, target in zip([f for f in self.fins if f.servo], turned, targets, strict=True)
        ]
        return np.concatenate([fossen(self.body, pose, self.wrench(nu_r, angles)), moved])

    def reference(self, start: np.ndarray, targets: np.ndarray, duration: float) -> np.ndarray:
        """The state after `duration`, the fins at rest first, by DOP853 at relative tolerance 1e-11."""
        begin = np.concatenate([start, np.zeros(len(targets))])
        solution = solve_ivp(
            lambda _, y: self.rate(y, targets), (0.0, duration), begin, method="DOP853", rtol=1e-11, atol=1e-12
        )
        return solution.y[:, -1]

    def spec(self, timestep: float = 0.005):
        """The model of it, an MjSpec."""
        numerics = "".join(fin.numerics() for fin in self.fins)
        if self.products:
            numerics += f'<numeric name="hull:velocity_products" data="{values(self.products)}"/>'
        if not self.coriolis:
            numerics += '<numeric name="hull:coriolis_of_added_mass" data="0"/>'
        if self.stations is not None:
            numerics += f'<numeric name="hull:cross_flow_stations" data="{values(self.stations)}"/>'
            numerics += f'<numeric name="hull:cross_flow_drag" data="{values(self.cross_flow)}"/>'
        extra = f"<custom>{numerics}</custom><actuator>{''.join(fin.actuator() for fin in self.fins)}</actuator>"
        return self.body.spec("RK4", timestep, "".join(fin.site() for fin in self.fins), extra)


def random_lifted(rng: np.random.Generator, body: Body) -> Lifted:
    """Three fins, a linear one and two that stall, with two servos; products, strips, and no Coriolis of added mass."""
    fins = []
    for name, stall, servo in (("a", None, (0.1, 0.8)), ("b", 0.3, (0.2, 0.5)), ("c", 0.4, None)):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        place, area = rng.uniform(-0.5, 0.5, 3), rng.uniform(0.005, 0.02)
        fins.append(Fin(name, place, axes[0], axes[1], area, rng.uniform(2.0, 5.0), stall, servo=servo))
    products = ((2, 1, 2, -3.0), (6, 1, -2, 1.5), (4, 5, 6, -0.2), (3, 1, 3, -2.0), (5, 4, 4, 0.1), (1, 2, 6, 0.5))
    stations = np.column_stack([[-0.6, -0.2, 0.1, 0.5], rng.uniform(0.02, 0.1, (4, 2))])
    return Lifted(replace(body), tuple(fins), products, stations, coriolis=False)
