"""A hull's numbers from its mesh or its size, each with where it comes from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cube_sim.errors import ShapeError
from cube_sim.hull_shape.added_mass import added_mass
from cube_sim.hull_shape.drag import drag_of
from cube_sim.hull_shape.mesh import ClosedMesh, box_mesh
from cube_sim.hull_shape.silhouette import silhouettes_of
from cube_sim.hull_shape.solid import solid_of
from cube_sim.spatial import Matrix, Vector

DENSITY = 1000.0
"""Of fresh water [kg/m^3]."""
GRAVITY = 9.81
LOWER = 0.05
"""Where nothing is said, the centre of mass lies this share of the hull's height below the centre of buoyancy (a
choice: vehicles are ballasted to float upright)."""
UNLIKELY = 20.0
"""A mesh that displaces so many times what the vehicle weighs, or so many times less, is in another unit."""
IMPOSSIBLE = 1000.0
"""Likewise, whatever its owner says (a choice: ten times its length, width and height)."""
FURTHEST = 1.0
"""Lengths of the hull that its centre of mass may be from its middle (a choice)."""
COARSE = 0.05
"""Added mass that refinement changes by more is worth a word."""
NEUTRAL = 0.02
"""Weight and lift that differ by less, relative, need no word."""


@dataclass(frozen=True)
class WeighedMass:
    """What is known of a vehicle's mass.

    Attributes:
        mass: [kg].
        centre_of_mass: (3,) [m], body axes; None where it is not known.
        inertia: (3,3) about the centre of mass [kg m^2]; None where it is not known.
        source: of centre and inertia, in words.
    """

    mass: float
    centre_of_mass: Vector | None
    inertia: Matrix | None
    source: str


def mass_of(mass: float, centre_of_mass: Vector | None = None) -> WeighedMass:
    """A mass [kg] alone, or with its centre (3,) [m], as its owner gave them."""
    return WeighedMass(mass, centre_of_mass, None, "as given")


@dataclass(frozen=True)
class HullDraft:
    """What an MJCF says of a hull, about its centre of buoyancy, body axes: there drag has the least coupling.

    Attributes:
        mass: [kg].
        origin: (3,) of the body axes, from the origin of what was given [m].
        centre_of_mass: (3,) [m].
        inertia: (3,3) about the centre of mass [kg m^2].
        volume: displaced [m^3].
        centre_of_buoyancy: (3,) [m]: zeros.
        added_mass: (6,6) [kg, kg m, kg m^2].
        linear_damping: (6,) [N s/m, N m s].
        quadratic_damping: (6,) [N s^2/m^2, N m s^2].
        middle: (3,) of the box around it [m].
        size: (3,) of that box [m].
        surface: of the hull, for pictures; None where it is that box.
        sources: of each of these, in words.
        remarks: what its owner should know.
    """

    mass: float
    origin: Vector
    centre_of_mass: Vector
    inertia: Matrix
    volume: float
    centre_of_buoyancy: Vector
    added_mass: Matrix
    linear_damping: Vector
    quadratic_damping: Vector
    middle: Vector
    size: Vector
    surface: ClosedMesh | None
    sources: Mapping[str, str]
    remarks: tuple[str, ...]


def hull_of_box(weighed: WeighedMass, size: Sequence[float], sure: bool) -> HullDraft:
    """A hull known by its size: neutrally buoyant, everything else as of a closed box.

    The origin of the body axes is the middle of the box.

    Args:
        weighed: its mass.
        size: (3,) [m].
        sure: whether a size that is unlikely for the mass is meant.

    Raises:
        ShapeError: size and mass, or centre of mass, are not of one vehicle.
    """
    what = f"a closed box of {' x '.join(f'{x:g}' for x in size)} m"
    return _hull(box_mesh(size), weighed, True, what, False, sure)


def hull_of_mesh(mesh: ClosedMesh, name: str, weighed: WeighedMass, neutral: bool) -> HullDraft:
    """A hull known by its surface.

    Args:
        mesh: its surface; the origin of the body axes is moved to its centroid.
        name: of the file, for the sources.
        weighed: its mass, centre of mass from the origin of the mesh.
        neutral: whether it displaces what it weighs, whatever the mesh encloses.

    Raises:
        ShapeError: mesh and mass, or centre of mass, are not of one vehicle.
    """
    return _hull(mesh, weighed, neutral, name, True, neutral)


def _hull(mesh: ClosedMesh, weighed: WeighedMass, neutral: bool, what: str, drawn: bool, sure: bool) -> HullDraft:
    origin = solid_of(mesh).centre
    mesh = mesh.moved(np.eye(3), origin)
    solid = solid_of(mesh)
    times = DENSITY * solid.volume / weighed.mass
    unit = f"a {'smaller' if times > 1.0 else 'larger'} --unit"
    unlikely = (
        ""
        if 1.0 / UNLIKELY <= times <= UNLIKELY
        else f"{what}: displaces {DENSITY * solid.volume:.3g} kg of water, and the vehicle weighs {weighed.mass:.3g} "
        f"kg; is the unit right ({unit if drawn else '--size-m is in metres'})?"
    )
    if unlikely and not sure:
        raise ShapeError(f"{unlikely} Say --neutral if it is")
    if not 1.0 / IMPOSSIBLE <= times <= IMPOSSIBLE:
        raise ShapeError(f"{unlikely} --neutral does not mend that")
    water, drag = added_mass(mesh, DENSITY), drag_of(silhouettes_of(mesh), solid.size, DENSITY)
    lower = np.array([0.0, 0.0, -LOWER * solid.size[2]])
    mass, given = weighed.mass, weighed.centre_of_mass
    centre = lower if given is None else np.asarray(given, dtype=float) - origin
    aside = centre - 0.5 * (solid.low + solid.high)
    if np.linalg.norm(aside) > FURTHEST * solid.size.max():
        raise ShapeError(
            f"centre of mass at {', '.join(f'{x:g}' for x in centre + origin)} m: is far outside {what}, which is "
            f"{' x '.join(f'{x:.3g}' for x in solid.size)} m; metres from the same origin are right"
        )
    inertia = mass * solid.inertia_per_mass if weighed.inertia is None else weighed.inertia
    volume = mass / DENSITY if neutral else solid.volume
    axes = ("surge", "sway", "heave")
    sources = {
        "volume": (
            f"neutrally buoyant: mass over density (choice; {what} encloses {1e3 * solid.volume:.4g} litres)"
            if neutral
            else f"what {what} encloses"
        ),
        "centre_of_buoyancy": f"centroid of {what}, which is the origin of the body axes",
        "centre_of_mass": (
            f"{LOWER:.0%} of the height below the centre of buoyancy (choice: measure yours)"
            if given is None
            else weighed.source
        ),
        "inertia": (
            f"{what} at uniform density, about the centre of mass (estimate)"
            if weighed.inertia is None
            else weighed.source
        ),
        "added_mass": (
            f"deeply submerged, in an ideal fluid: {water.panels} panels on {what}, carried on to infinitely many; the "
            f"last step changed {water.error:.1%} (cube_sim/hull_shape/added_mass.py)"
        ),
        "quadratic_damping": "1/2 rho C A, estimate: "
        + "; ".join(
            f"{axis} C = {value:.2f}, {like}"
            for axis, value, like in zip(axes, drag.coefficients, drag.likened, strict=True)
        )
        + "; rotation by strips (Hoerner 1965, ch. 3, and White 2011, table 7.3: cube_sim/hull_shape/drag.py)",
        "linear_damping": "the quadratic drag at 0.1 m/s, as identified tables of small vehicles have it (choice)",
    }
    remarks = [*mesh.remarks, *([unlikely] if unlikely else [])]
    lift, weight = DENSITY * volume * GRAVITY, mass * GRAVITY
    if abs(lift - weight) > NEUTRAL * weight:
        way = "rises" if lift > weight else "sinks"
        remarks.append(
            f"{what} displaces {DENSITY * volume:.4g} kg of water and weighs {mass:.4g} kg: it {way} with "
            f"{abs(lift - weight):.3g} N. Ballast it, or say --neutral where the mesh is not what is solid"
        )
    if water.error > COARSE:
        remarks.append(
            f"added mass: the last step of refinement still changed {water.error:.1%}; thin or many-edged hulls "
            "converge slowly"
        )
    if np.hypot(*centre[:2]) > 0.2 * abs(centre[2]) + 1e-9:
        remarks.append(
            "the centre of buoyancy is not above the centre of mass: at rest the hull leans until it is, unless its "
            "thrusters hold it"
        )
    if (np.abs(aside) > 0.5 * solid.size).any():
        remarks.append(f"the centre of mass is outside the box around {what}")
    if centre[2] > 0.0:
        remarks.append("the centre of buoyancy is below the centre of mass: the hull turns upside down by itself")
    return HullDraft(
        mass=mass,
        origin=origin,
        centre_of_mass=centre,
        inertia=inertia,
        volume=volume,
        centre_of_buoyancy=np.zeros(3),
        added_mass=water.matrix,
        linear_damping=drag.linear,
        quadratic_damping=drag.quadratic,
        middle=0.5 * (solid.low + solid.high),
        size=solid.size,
        surface=mesh if drawn else None,
        sources=sources,
        remarks=tuple(remarks),
    )
