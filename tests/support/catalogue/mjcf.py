"""A vehicle given as a table of numbers, written as MJCF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

T200 = (
    (-1.00, -39.91), (-0.90, -35.85), (-0.80, -29.36), (-0.70, -24.07), (-0.60, -19.04), (-0.50, -14.10),
    (-0.40, -10.01), (-0.30, -6.36), (-0.20, -3.16), (-0.08, -0.356), (-0.07, 0.0), (0.07, 0.0), (0.08, 0.400),
    (0.15, 2.135), (0.25, 5.92), (0.35, 10.14), (0.45, 15.08), (0.55, 20.82), (0.65, 27.05), (0.75, 33.54),
    (0.85, 41.72), (0.95, 49.15), (1.00, 51.44),
)  # fmt: skip
"""Command and thrust [N] at 16 V: Blue Robotics public performance workbook, 2019."""

T200_MOST_N, T200_DEAD_ZONE_N = 51.44, (-0.356, 0.400)


class Thruster(NamedTuple):
    """Where a thruster is and what it does.

    Attributes:
        position: (3,) [m], body axes.
        axis: (3,) the way it pushes, of any length.
        reaction_m: torque about its own axis per newton of thrust [m], of either sign.
        share: of the thrust that `Layout.thrust` says; a fin given as a thruster makes less than the propeller.
    """

    position: ArrayLike
    axis: ArrayLike
    reaction_m: float = 0.0
    share: float = 1.0


@dataclass(frozen=True)
class Hull:
    """A rigid body in water, SI units, body axes FLU with the origin at the centre of mass unless it is given.

    Attributes:
        mass: [kg].
        inertia: (3,) diagonal, or (6,) xx yy zz xy xz yz [kg m^2].
        box: (3,) edges [m], for contact and pictures.
        centre_of_buoyancy: (3,) [m].
        added_mass: (6,) diagonal or (36,) by rows.
        linear_damping: (6,) or (36,).
        quadratic_damping: (6,) or (36,).
        volume: [m^3]; None for weight and lift that are equal.
        centre_of_mass: (3,) [m].
        density: of the water [kg/m^3].
    """

    mass: float
    inertia: Sequence[float]
    box: Sequence[float]
    centre_of_buoyancy: Sequence[float]
    added_mass: Sequence[float]
    linear_damping: Sequence[float]
    quadratic_damping: Sequence[float]
    volume: float | None = None
    centre_of_mass: Sequence[float] = (0.0, 0.0, 0.0)
    density: float = 1000.0


@dataclass(frozen=True)
class Layout:
    """A hull and its thrusters, T1 to Tm.

    Attributes:
        hull: the body.
        thrusters: in order.
        thrust: largest thrust ahead [N] of a thruster of share 1, whose curve is a T200's, stretched to this.
        lag_s: time in which a thruster makes 63 % of a step [s].
    """

    hull: Hull
    thrusters: Sequence[Thruster]
    thrust: float = T200_MOST_N
    lag_s: float = 0.02


def box_hull(
    mass: float,
    box: ArrayLike,
    rise: float,
    *,
    drag_coefficient: float = 1.0,
    linear_at_m_s: float = 0.1,
    added_share: float = 1.0,
) -> Hull:
    """A hull whose numbers are scaled from its box; the scaling is a choice, good to a factor of two.

    - Drag across a face of area S: 1/2 rho C S |u| u. Turning, the same pressure along both arms of length l/2:
      1/2 rho C w l^4 / 32 for each of the two faces' widths w.
    - Linear damping is what the quadratic one gives at a small speed: the two are equal there.
    - Added mass of a face a x b, a <= b: a plate's, pi/4 rho a^2 b times b / sqrt(a^2 + b^2) (Brennen 1982, table 3,
      rounded). Turning: a strip's pi/4 rho w^2 along both arms, pi/4 rho w^2 l^3 / 12, w at most l.
    - Inertia: a uniform box's.

    Args:
        mass: [kg]; weight and lift are equal.
        box: (3,) edges [m].
        rise: of the centre of buoyancy above the centre of mass [m].
        drag_coefficient: 1 for a bluff body.
        linear_at_m_s: speed at which both kinds of drag are equal [m/s].
        added_share: factor on the added mass; a frame that water passes has less than a plate.
    """
    rho, edges = 1000.0, np.asarray(box, float)
    added, drag = np.zeros(6), np.zeros(6)
    for i in range(3):
        a, b = sorted(np.delete(edges, i))
        drag[i] = 0.5 * rho * drag_coefficient * a * b
        added[i] = added_share * 0.25 * np.pi * rho * a * a * b * b / np.hypot(a, b)
        for length in (a, b):
            drag[3 + i] += 0.5 * rho * drag_coefficient * edges[i] * length**4 / 32.0
            added[3 + i] += added_share * np.pi / 48.0 * rho * min(edges[i], length) ** 2 * length**3
    inertia = mass / 12.0 * (np.sum(edges**2) - edges**2)
    turning_speed = linear_at_m_s / (0.25 * float(np.mean(edges)))
    linear = drag * np.array([linear_at_m_s] * 3 + [turning_speed] * 3)
    return Hull(mass, tuple(inertia), tuple(edges), (0.0, 0.0, rise), tuple(added), tuple(linear), tuple(drag))


def mjcf(name: str, layout: Layout) -> str:
    """The MJCF text of a layout; its body is called `hull`."""
    hull = layout.hull
    volume = hull.mass / hull.density if hull.volume is None else hull.volume
    inertia = "diaginertia" if len(hull.inertia) == 3 else "fullinertia"
    numerics = {
        "water:density": [hull.density],
        "hull:volume": [volume],
        "hull:centre_of_buoyancy": hull.centre_of_buoyancy,
        "hull:added_mass": hull.added_mass,
        "hull:linear_damping": hull.linear_damping,
        "hull:quadratic_damping": hull.quadratic_damping,
        "hull:thruster_power": [1.449, 0.997],
    }
    sites, actuators = [], []
    for i, thruster in enumerate(layout.thrusters, 1):
        stretch = layout.thrust * thruster.share / T200_MOST_N
        numerics[f"T{i}:thruster_characteristic"] = [x for c, force in T200 for x in (c, stretch * force)]
        numerics[f"T{i}:thruster_dead_zone"] = [stretch * force for force in T200_DEAD_ZONE_N]
        sites.append(f'<site name="T{i}" pos="{_row(thruster.position)}" zaxis="{_row(thruster.axis)}"/>')
        gear = _row((0, 0, 1, 0, 0, thruster.reaction_m))
        actuators.append(
            f'<general name="T{i}" site="T{i}" gear="{gear}" dyntype="filter" dynprm="{layout.lag_s:.12g}" '
            'gaintype="fixed" gainprm="0" biastype="user" ctrlrange="-1 1"/>'
        )
    said = "\n    ".join(f'<numeric name="{key}" data="{_row(values)}"/>' for key, values in numerics.items())
    placed, driven = "\n      ".join(sites), "\n    ".join(actuators)
    return f"""<mujoco model="{name}">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.01" integrator="RK4" gravity="0 0 -9.81" wind="0 0 0"/>
  <custom>
    {said}
  </custom>
  <worldbody>
    <body name="hull">
      <freejoint/>
      <inertial pos="{_row(hull.centre_of_mass)}" mass="{hull.mass:.12g}" {inertia}="{_row(hull.inertia)}"/>
      <geom type="box" size="{_row(0.5 * np.asarray(hull.box))}" contype="0" conaffinity="0"/>
      {placed}
    </body>
  </worldbody>
  <actuator>
    {driven}
  </actuator>
</mujoco>
"""


def _row(values: object) -> str:
    return " ".join(f"{value:.12g}" for value in np.ravel(np.asarray(values, float)))
