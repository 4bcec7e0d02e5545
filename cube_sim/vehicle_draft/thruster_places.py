"""Where thrusters are, which way they push and what they are: from flags of the command line, or a CSV file."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cube_sim.csv_columns import wrong_columns
from cube_sim.errors import ShapeError
from cube_sim.hull_shape.reading import FRAMES
from cube_sim.nearest import counted
from cube_sim.spatial import LARGEST, Vector

COLUMNS = ("name", "x_m", "y_m", "z_m", "axis_x", "axis_y", "axis_z", "type")
FORM = "NAME=x,y,z:axis:TYPE, for example T1=0.15,-0.11,0:1,1,0:T200"
FURTHEST = 3.0
"""Diagonals of the hull that a thruster may be from its middle (a choice)."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_AXES = {
    f"{sign}{letter}": (value, i) for i, letter in enumerate("xyz") for sign, value in (("", 1), ("+", 1), ("-", -1))
}


@dataclass(frozen=True)
class ThrusterPlace:
    """One thruster.

    Attributes:
        name: of its actuator and its site.
        place: (3,) of its propeller [m], body axes.
        axis: (3,) unit, the way it pushes the hull at a positive command, body axes.
        kind: its type.
        where: it is given, in the words of an error.
    """

    name: str
    place: Vector
    axis: Vector
    kind: str
    where: str = ""


def places_of_flags(flags: Sequence[str], frame: str, types: Sequence[str]) -> list[ThrusterPlace]:
    """Thrusters as `FORM` has them.

    Args:
        flags: one for each.
        frame: one of `cube_sim.hull_shape.reading.FRAMES`, of places and axes.
        types: of thrusters that are known.

    Raises:
        ShapeError: names the flag.
    """
    places = []
    for flag in flags:
        name, equals, rest = flag.partition("=")
        parts = rest.split(":")
        if not equals or len(parts) != 3:
            raise ShapeError(f"--thruster {flag}: is not of the form {FORM}")
        places.append(
            _place(f"--thruster {flag}", name, parts[0].split(","), _axis_words(parts[1]), parts[2], frame, types)
        )
    _require_names_apart(places)
    return places


def places_of_file(file: Path, frame: str, types: Sequence[str]) -> list[ThrusterPlace]:
    """Thrusters of a CSV file with the columns `COLUMNS`; lines that begin with # are remarks.

    Args:
        file: its name.
        frame: as for `places_of_flags`.
        types: likewise.

    Raises:
        ShapeError: one line, `file:line: what is wrong`.
    """
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise ShapeError(f"{file}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError:
        raise ShapeError(f"{file}: is not UTF-8 text") from None
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if not numbered:
        raise ShapeError(f"{file}: is empty; a line of {','.join(COLUMNS)} and one for each thruster are right")
    rows = [[cell.strip() for cell in row] for row in csv.reader(line for _, line in numbered)]
    if (wrong := wrong_columns(rows[0], COLUMNS)) is not None:
        raise ShapeError(f"{file}:{numbered[0][0]}: {wrong}")
    places = []
    for (number, _), row in zip(numbered[1:], rows[1:], strict=True):
        if len(row) != len(COLUMNS):
            raise ShapeError(f"{file}:{number}: has {counted(len(row), 'value')}; {len(COLUMNS)} are right")
        places.append(_place(f"{file}:{number}", row[0], row[1:4], row[4:7], row[7], frame, types))
    if not places:
        raise ShapeError(f"{file}: has no thruster below its first line")
    _require_names_apart(places)
    return places


def places_from(origin: Vector, places: Sequence[ThrusterPlace]) -> list[ThrusterPlace]:
    """The same thrusters, their places from another origin (3,) [m]."""
    return [replace(place, place=place.place - origin) for place in places]


def require_near(places: Sequence[ThrusterPlace], middle: Vector, size: Vector) -> None:
    """Refuse thrusters that are not on the vehicle, as places in millimetres are.

    Args:
        places: of the thrusters.
        middle: (3,) of the box around the hull [m].
        size: (3,) of that box [m].

    Raises:
        ShapeError: names the thruster.
    """
    for place in places:
        away = float(np.linalg.norm(place.place - middle))
        if away > FURTHEST * float(np.linalg.norm(size)):
            raise ShapeError(
                f"{place.where}: thruster {place.name} is {away:.3g} m from the middle of a hull {size.max():.3g} m "
                "long; places are metres, from the origin of the mesh or the middle of the box"
            )


def _axis_words(text: str) -> list[str]:
    if text in _AXES:
        value, at = _AXES[text]
        return [str(value if i == at else 0) for i in range(3)]
    return text.split(",")


def _place(
    where: str, name: str, place: list[str], axis: list[str], kind: str, frame: str, types: Sequence[str]
) -> ThrusterPlace:
    if not _NAME.fullmatch(name):
        raise ShapeError(f"{where}: '{name}' is no name; letters, digits, - and _ are right, a letter first")
    if kind.upper() not in types:
        raise ShapeError(f"{where}: '{kind}' is no thruster that is known by name; {', '.join(types)} are")
    at, along = _three(where, "a place [m]", place), _three(where, "an axis", axis)
    length = float(np.linalg.norm(along))
    if length < 1e-9:
        raise ShapeError(f"{where}: its axis has no length; the direction in which it pushes the hull is right")
    turn = FRAMES[frame]
    return ThrusterPlace(name, turn @ at, turn @ along / length, kind.upper(), where)


def _three(where: str, what: str, words: list[str]) -> Vector:
    try:
        values = np.array([float(word) for word in words])
    except ValueError:
        values = np.zeros(0)
    if values.shape != (3,) or not (np.abs(values) <= LARGEST).all():
        raise ShapeError(f"{where}: '{','.join(words)}' is not {what}; three numbers are")
    return values


def _require_names_apart(places: Sequence[ThrusterPlace]) -> None:
    taken = {"hull", "imu", "around"}
    for place in places:
        if place.name in taken:
            raise ShapeError(
                f"{place.where}: the name {place.name} is taken already; each thruster needs its own, and hull, imu "
                "and around are the vehicle's"
            )
        taken.add(place.name)
