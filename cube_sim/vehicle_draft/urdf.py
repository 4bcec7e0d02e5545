"""Mass, centre of mass and inertia of a robot described in URDF, all links at joint angles of zero."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

from cube_sim.errors import ShapeError
from cube_sim.spatial import Matrix, Vector


@dataclass(frozen=True)
class LinkInertia:
    """What all links weigh together, about the origin of the root link, x forward, y left, z up as REP-103 has it.

    Attributes:
        mass: [kg].
        centre_of_mass: (3,) [m].
        inertia: (3,3) about the centre of mass [kg m^2].
        links: how many of them have mass.
    """

    mass: float
    centre_of_mass: Vector
    inertia: Matrix
    links: int


def read_urdf(file: Path) -> LinkInertia:
    """Read the inertials of a URDF, by MuJoCo; shapes and their meshes are left alone.

    Raises:
        ShapeError: one line with the file, and the line where XML ends to be XML.
    """
    try:
        root = ElementTree.fromstring(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ShapeError(f"{file}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError:
        raise ShapeError(f"{file}: is not UTF-8 text") from None
    except ElementTree.ParseError as error:
        line, column = error.position
        raise ShapeError(f"{file}:{line}:{column + 1}: is no XML: {str(error).partition(':')[0]}") from None
    if root.tag != "robot":
        raise ShapeError(f"{file}: is no URDF: its root is <{root.tag}>, <robot> is right (run xacro first)")
    for link in root.iter("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    try:
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
        spec.compiler.fusestatic = False
        model = spec.compile()
    except ValueError as error:
        raise ShapeError(f"{file}: MuJoCo does not read it: {' '.join(str(error).split())}") from None
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    masses = model.body_mass
    if masses.sum() <= 0.0:
        raise ShapeError(f"{file}: no link has an <inertial> with a mass")
    centre = masses @ data.xipos / masses.sum()
    inertia = np.zeros((3, 3))
    for mass, moments, at, turn in zip(
        masses, model.body_inertia, data.xipos, data.ximat.reshape(-1, 3, 3), strict=True
    ):
        away = at - centre
        inertia += turn @ np.diag(moments) @ turn.T + mass * (away @ away * np.eye(3) - np.outer(away, away))
    return LinkInertia(float(masses.sum()), centre, inertia, int((masses > 0.0).sum()))
