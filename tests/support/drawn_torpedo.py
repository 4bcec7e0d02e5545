"""Torpedoes drawn at random: a hull by slender-body numbers, a propeller, and fins astern, at its bow too at times."""

from __future__ import annotations

from math import atanh, log10, pi, sqrt
from typing import NamedTuple

import numpy as np

WATER_KG_M3 = 1000.0
MODEL = """<mujoco model="drawn_torpedo">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.01" integrator="RK4" gravity="0 0 -9.81" wind="0 0 0"/>
  <custom>
    <numeric name="water:density" data="1000"/>
    <numeric name="hull:volume" data="{volume:.9g}"/>
    <numeric name="hull:centre_of_buoyancy" data="0 0 {above:.9g}"/>
    <numeric name="hull:added_mass" data="{added}"/>
    <numeric name="hull:linear_damping" data="0 0 0 {roll_damping:.9g} 0 0"/>
    <numeric name="hull:quadratic_damping" data="{drag:.9g} 0 0 0 0 0"/>
    <numeric name="hull:cross_flow_drag" data="1.1 1.1"/>
    <numeric name="hull:cross_flow_stations" data="{stations}"/>
    <numeric name="hull:velocity_products" data="{products}"/>
    <numeric name="propeller:thruster_characteristic" data="-1 {back:.9g} 0 0 1 {ahead:.9g}"/>
    <numeric name="propeller:thruster_dead_zone" data="0 0"/>
    {numbers}
  </custom>
  <worldbody>
    <body name="hull" pos="0 0 0">
      <freejoint name="hull"/>
      <inertial pos="0 0 0" mass="{mass:.9g}" diaginertia="{inertia}"/>
      <geom name="hull" type="capsule" size="{radius:.9g} {half:.9g}" zaxis="1 0 0"/>
      <site name="imu" pos="0 0 0"/>
      <site name="propeller" pos="{stern:.9g} 0 0" zaxis="1 0 0"/>
      {sites}
    </body>
  </worldbody>
  <actuator>
    <general name="propeller" site="propeller" gear="0 0 1 0 0 0" dyntype="filter" dynprm="0.1" gaintype="fixed"
             gainprm="0" biastype="user" ctrlrange="-1 1"/>
    {servos}
  </actuator>
</mujoco>
"""


class DrawnTorpedo(NamedTuple):
    """What was drawn.

    Attributes:
        text: MJCF.
        length_m: of the hull.
        speed_m_s: at which it cruises.
        words: what it is.
    """

    text: str
    length_m: float
    speed_m_s: float
    words: str


def drawn_torpedo(seed: int) -> DrawnTorpedo:
    """One of 1 to 5 m, 5 to 10 times as long as thick, with 2.5 to 10 % of its profile as area of each pair of fins.

    Added mass is that of the prolate ellipsoid (H. Lamb, Hydrodynamics, 1932, art. 114 and 115), the drag ahead that of
    a plate of its surface, half as much again (S. F. Hoerner, Fluid-Dynamic Drag, 1965), the drag across 1.1 for each
    strip, the lift of the hull one per radian on its cross-section squared, 0.15 of the length behind its middle.
    """
    rng = np.random.default_rng(seed)
    length, slender = float(rng.uniform(1.0, 5.0)), float(rng.uniform(5.0, 10.0))
    speed, share = float(rng.uniform(0.9, 2.0)), float(rng.uniform(0.025, 0.1))
    tail, bow = ("cruciform", "four", "x")[int(rng.integers(3))], bool(rng.integers(2))
    above, travel = float(rng.uniform(0.03, 0.12)), float(rng.uniform(0.25, 0.4))
    thick = length / slender
    volume = 0.8 * pi / 4.0 * thick**2 * length
    mass = WATER_KG_M3 * volume
    ahead, aside, turning = _ellipsoid(slender)
    about = mass * 0.06 * length**2
    added = mass * ahead, mass * aside, mass * aside, 0.05 * mass * thick**2, turning * about, turning * about
    wetted = 0.85 * pi * thick * length
    friction = 0.075 / (log10(speed * length / 1.2e-6) - 2.0) ** 2
    drag = 0.5 * WATER_KG_M3 * 1.5 * (friction + 5e-4) * wetted
    lift = 0.5 * WATER_KG_M3 * thick**2
    x = 0.15 * length
    products = f"2 1 2 {-lift} 3 1 3 {-lift} 6 1 2 {lift * x} 5 1 3 {-lift * x}"
    cells = np.linspace(-0.5, 0.5, 12)[:-1] + 0.5 / 11
    breadth = thick * np.sqrt(1.0 - (2.0 * cells) ** 2) ** 0.5
    stations = "   ".join(f"{at * length:.6g} {wide:.6g} {wide:.6g}" for at, wide in zip(cells, breadth, strict=True))
    fins = _fins(tail, bow, share * length * thick, length, thick)
    sites = servos = numbers = ""
    for name, place, span, area in fins:
        at, along = (" ".join(f"{number:.9g}" for number in each) for each in (place, span))
        sites += f'<site name="{name}" pos="{at}" xyaxes="1 0 0 {along}"/>\n      '
        servos += f'<general name="{name}" site="{name}" dyntype="user" dynprm="0.1 1" gainprm="0" '
        servos += f'ctrlrange="{-travel:.6g} {travel:.6g}"/>\n    '
        numbers += f'<numeric name="{name}:fin_area" data="{area:.9g}"/><numeric name="{name}:fin_aspect_ratio" '
        numbers += f'data="3"/><numeric name="{name}:fin_stall" data="0.35"/><numeric name="{name}:fin_drag" '
        numbers += 'data="0.01 0.9"/>\n    '
    fin_drag = 0.5 * WATER_KG_M3 * 0.01 * sum(area for *_, area in fins)
    most = (drag + fin_drag) * (1.8 * speed) ** 2
    text = MODEL.format(
        volume=volume,
        above=above * thick,
        added=" ".join(f"{number:.9g}" for number in added),
        roll_damping=0.05 * mass * thick**2,
        drag=drag,
        stations=stations,
        products=products,
        back=-0.5 * most,
        ahead=most,
        numbers=numbers,
        mass=mass,
        inertia=f"{0.1 * mass * thick**2:.9g} {about:.9g} {about:.9g}",
        radius=0.5 * thick,
        half=0.5 * (length - thick),
        stern=-0.5 * length,
        sites=sites,
        servos=servos,
    )
    words = (
        f"{length:.1f} m, {slender:.1f} thick, {100 * share:.1f} % {tail}{' and bow' if bow else ''}, {speed:.1f} m/s"
    )
    return DrawnTorpedo(text, length, speed, words)


def _ellipsoid(slender: float) -> tuple[float, float, float]:
    """Lamb's k_1, k_2 and k' of a prolate ellipsoid."""
    e = sqrt(1.0 - 1.0 / slender**2)
    log = 2.0 * atanh(e)
    alpha = 2.0 * (1.0 - e**2) / e**3 * (0.5 * log - e)
    beta = 1.0 / e**2 - (1.0 - e**2) / (2.0 * e**3) * log
    turning = e**4 * (beta - alpha) / ((2.0 - e**2) * (2.0 * e**2 - (2.0 - e**2) * (beta - alpha)))
    return alpha / (2.0 - alpha), beta / (2.0 - beta), turning


def _fins(tail: str, bow: bool, area: float, length: float, thick: float) -> list[tuple]:
    """Name, place, span and area [m^2] of each; `area` of a pair."""
    stern, out, fins = -0.43 * length, 0.7 * thick, []
    if tail == "cruciform":
        fins += [
            ("planes", [stern, 0.0, 0.0], [0.0, 1.0, 0.0], area),
            ("rudder", [stern, 0.0, 0.0], [0.0, 0.0, 1.0], area),
        ]
    else:
        for i in range(4):
            angle = i * pi / 2.0 + (pi / 4.0 if tail == "x" else 0.0)
            span = np.array([0.0, np.cos(angle), np.sin(angle)])
            fins.append((f"fin{i + 1}", np.array([stern, 0.0, 0.0]) + out * span, span, 0.5 * area))
    if bow:
        fins.append(("bow_planes", [0.35 * length, 0.0, 0.0], [0.0, 1.0, 0.0], 0.6 * area))
    return fins
