"""The MJCF of a drafted vehicle, every number with its source beside it."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.known_thrusters import KnownThruster
from cube_sim.vehicle.thruster_tables import FULL_US, REST_US
from cube_sim.vehicle_draft.hull import DENSITY, GRAVITY, HullDraft
from cube_sim.vehicle_draft.thruster_places import ThrusterPlace

_WIDTH = 112
_MOST_DRAWN = 20_000
"""Triangles of a surface that goes along for pictures; a finer one is left at its owner's."""
_COUPLED = 1e-3
"""Entries of the added mass below this share of its diagonal are rounding, and left out."""


def mjcf_text(
    name: str,
    hull: HullDraft,
    places: Sequence[ThrusterPlace],
    kinds: dict[str, KnownThruster],
    at_voltages: Mapping[str, Sequence[KnownThruster]] | None = None,
) -> str:
    """An MJCF file.

    Args:
        name: of the model.
        hull: its numbers.
        places: of its thrusters.
        kinds: by the name of the type.
        at_voltages: the same at several voltages, for those that a battery feeds.
    """
    first = kinds[places[0].kind]
    lines = [
        f'<mujoco model="{name}">',
        *_comment(
            "  ",
            "Drafted by cube-sim new vehicle. SI units; world ENU (z up), body FLU (x forward, y left, z up). What is "
            "marked as a choice or an estimate is to be replaced by what you measure: weigh it, time its roll, let it "
            "drift, tow it.",
        ),
        *_comment(
            "  ",
            "The origin of the body axes is the centre of buoyancy, for drag is given without coupling: it stands at "
            f"({', '.join(_of(hull.origin).split())}) m, x forward, y left, z up, from the origin of what was given; "
            "places here are given ones less that.",
        ),
        '  <compiler angle="radian" autolimits="true"/>',
        "",
        f'  <option timestep="0.01" integrator="RK4" gravity="0 0 -{GRAVITY:g}" wind="0 0 0"/>',
        "",
        "  <custom>",
        *_comment("    ", "fresh water [kg/m^3]; the sea has 1025"),
        f'    <numeric name="water:density" data="{DENSITY:g}"/>',
    ]
    numbers = {
        "volume": ("displaced volume [m^3]", [hull.volume]),
        "centre_of_buoyancy": ("[m], body axes", hull.centre_of_buoyancy),
        "added_mass": ("[kg, kg m, kg m^2]", _matrix(hull.added_mass)),
        "linear_damping": ("[N s/m, N m s]", hull.linear_damping),
        "quadratic_damping": ("[N s^2/m^2, N m s^2]", hull.quadratic_damping),
    }
    for key, (unit, values) in numbers.items():
        lines += _comment("    ", f"{unit}: {hull.sources[key]}")
        lines += _numeric(f"hull:{key}", values, 6)
    powers = all(of.power is not None for of in kinds.values())  # a hull's would serve those without as well
    for owner, of in [("hull", first), *((p.name, kinds[p.kind]) for p in places if p.kind != first.name)]:
        if of.name in (at_voltages or {}):
            lines += _at_voltages(owner, (at_voltages or {})[of.name])
        else:
            lines += _one_curve(owner, of, powers)
        lines += _numeric(f"{owner}:thruster_voltage", [of.voltage], 6)
        lines += _numeric(f"{owner}:thruster_pwm", [REST_US - FULL_US, REST_US, REST_US + FULL_US], 6)
    inertia = hull.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    lines += [
        "  </custom>",
        "",
        *_asset(name, hull),
        "  <default>",
        '    <default class="thruster">',
        *_comment("      ", "command, lag [s], characteristic, force along the site's z axis"),
        f'      <general gear="0 0 1 0 0 0" dyntype="filter" dynprm="{first.lag_s:g}" gaintype="fixed" gainprm="0"',
        '               biastype="user" ctrlrange="-1 1"/>',
        '      <site type="cylinder" size="0.045 0.02" rgba="0.15 0.15 0.18 1"/>',
        "    </default>",
        "  </default>",
        "",
        "  <worldbody>",
        '    <light name="sun" pos="0 0 20" dir="0 0 -1" type="directional"/>',
        '    <body name="hull">',
        '      <freejoint name="hull"/>',
        *_comment("      ", f"centre of mass: {hull.sources['centre_of_mass']}; inertia: {hull.sources['inertia']}"),
        f'      <inertial pos="{_of(hull.centre_of_mass)}" mass="{hull.mass:.6g}"',
        f'                fullinertia="{_of(inertia)}"/>',
        *_geoms(hull),
        '      <site name="imu" pos="0 0 0"/>',
    ]
    lines += [
        f'      <site name="{p.name}" class="thruster" pos="{_of(p.place)}" zaxis="{_of(p.axis, 17)}"/>' for p in places
    ]
    lines += ["    </body>", "  </worldbody>", "", "  <actuator>"]
    lines += [f'    <general name="{p.name}" class="thruster" site="{p.name}"/>' for p in places]
    return "\n".join([*lines, "  </actuator>", "</mujoco>"]) + "\n"


def _one_curve(owner: str, of: KnownThruster, powers: bool) -> list[str]:
    lines = _comment("    ", f"{of.source}: pairs of command and thrust [N], command = (pulse - 1500 us)/400 us")
    lines += _numeric(f"{owner}:thruster_characteristic", np.column_stack([of.commands, of.forces]).ravel(), 10)
    lines += _comment(
        "    ",
        f"first thrusts [N]; {'k of the electrical power k |F|^1.5 [W]; ' if powers else ''}their voltage; pulses [us]",
    )
    lines += _numeric(f"{owner}:thruster_dead_zone", of.force_dead_zone, 6)
    return lines + (_numeric(f"{owner}:thruster_power", of.power, 6) if powers and of.power is not None else [])


def _at_voltages(owner: str, each: Sequence[KnownThruster]) -> list[str]:
    lines = _comment(
        "    ",
        f"{each[0].source} and at {', '.join(f'{of.voltage:g}' for of in each[1:])} V: rows of voltage, command and "
        "thrust [N], command = (pulse - 1500 us)/400 us; a battery's voltage lies between them",
    )
    pushes = [np.column_stack([np.full(len(of.forces), of.voltage), of.commands, of.forces]) for of in each]
    table = np.concatenate(pushes)
    lines += _numeric(f"{owner}:thruster_voltage_table", table[table[:, 2] != 0.0].ravel(), 9)
    lines += _comment(
        "    ", "k of the electrical power k |F|^1.5 [W] at each; the voltage without a battery; pulses [us]"
    )
    known = [of.power for of in each if of.power is not None]
    return lines + (_numeric(f"{owner}:thruster_power", np.ravel(known), 6) if len(known) == len(each) else [])


def mesh_text(hull: HullDraft) -> str | None:
    """The hull's surface as an OBJ file, for pictures; None where it is a box."""
    if hull.surface is None or len(hull.surface.faces) > _MOST_DRAWN:
        return None
    lines = ["# The hull about its centre of buoyancy, metres, x forward, y left, z up; for pictures."]
    lines += [f"v {_of(vertex, 7)}" for vertex in hull.surface.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in hull.surface.faces + 1]
    return "\n".join(lines) + "\n"


def _asset(name: str, hull: HullDraft) -> list[str]:
    if mesh_text(hull) is None:
        return []
    return ["  <asset>", f'    <mesh name="hull" file="{name}.obj" inertia="shell"/>', "  </asset>", ""]


def _geoms(hull: HullDraft) -> list[str]:
    box = f'type="box" pos="{_of(hull.middle)}" size="{_of(0.5 * hull.size)}"'
    if mesh_text(hull) is None:
        lines = _comment("      ", "the box around the hull, for contact and pictures only")
        return [*lines, f'      <geom name="hull" {box} rgba="0.15 0.35 0.75 0.6"/>']
    return [
        *_comment("      ", "for pictures; and the box around it, for contact"),
        '      <geom name="hull" type="mesh" mesh="hull" contype="0" conaffinity="0" rgba="0.15 0.35 0.75 1"/>',
        f'      <geom name="around" {box} group="3" rgba="0.5 0.5 0.5 0"/>',
    ]


def _matrix(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Its diagonal (6,) where nothing is coupled, else all of it (36,)."""
    scale = np.sqrt(np.outer(matrix.diagonal(), matrix.diagonal()))
    kept = np.where(np.abs(matrix) > _COUPLED * scale, matrix, 0.0)
    off = kept - np.diag(kept.diagonal())
    return kept.ravel() if off.any() else kept.diagonal()


def _of(values: Iterable[float], digits: int = 5) -> str:
    return " ".join(f"{0.0 if abs(value) < 1e-12 else value:.{digits}g}" for value in values)


def _numeric(name: str, values: Iterable[float], a_line: int) -> list[str]:
    told = _of(values).split()
    if len(told) <= a_line:
        return [f'    <numeric name="{name}" data="{" ".join(told)}"/>']
    rows = [" ".join(told[i : i + a_line]) for i in range(0, len(told), a_line)]
    return [f'    <numeric name="{name}" data="', *(f"      {row}" for row in rows[:-1]), f'      {rows[-1]}"/>']


def _comment(indent: str, text: str) -> list[str]:
    """An XML comment, in which two hyphens must not stand together."""
    safe = escape(re.sub(r"-(?=-)", "- ", text))
    rows = textwrap.wrap(safe, _WIDTH - len(indent), break_long_words=False, break_on_hyphens=False)
    if len(rows) == 1:
        return [f"{indent}<!-- {rows[0]} -->"]
    return [f"{indent}<!-- {rows[0]}", *(f"{indent}     {row}" for row in rows[1:-1]), f"{indent}     {rows[-1]} -->"]
