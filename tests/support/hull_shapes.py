"""Surfaces of which theory knows everything, as triangles and as files."""

import numpy as np
from scipy.integrate import quad

ICOSAHEDRON = np.array(
    [
        "0",
        "11",
        "5",
        "0",
        "5",
        "1",
        "0",
        "1",
        "7",
        "0",
        "7",
        "10",
        "0",
        "10",
        "11",
        "1",
        "5",
        "9",
        "5",
        "11",
        "4",
        "11",
        "10",
        "2",
        "10",
        "7",
        "6",
        "7",
        "1",
        "8",
        "3",
        "9",
        "4",
        "3",
        "4",
        "2",
        "3",
        "2",
        "6",
        "3",
        "6",
        "8",
        "3",
        "8",
        "9",
        "4",
        "9",
        "5",
        "2",
        "4",
        "11",
        "6",
        "2",
        "10",
        "8",
        "6",
        "7",
        "9",
        "8",
        "1",
    ],
    dtype=int,
).reshape(-1, 3)


def quartered(triangles):
    """Four (4k,3,3) for each."""
    a, b, c = (triangles[:, i] for i in range(3))
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])


def ellipsoid(axes, divisions):
    """Triangles (20 * 4^divisions, 3, 3) with corners on an ellipsoid."""
    t = (1 + 5**0.5) / 2
    corners = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t)]
    corners = np.array([*corners, (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)], dtype=float)
    triangles = corners[ICOSAHEDRON]
    for _ in range(divisions):
        triangles = quartered(triangles)
    return triangles / np.linalg.norm(triangles, axis=2)[..., None] * np.asarray(axes)


def ellipsoid_added_mass(axes):
    """Diagonal (6,) for water of density 1 (Lamb, Hydrodynamics, arts. 114 and 115)."""
    a, b, c = axes
    volume = 4 / 3 * np.pi * a * b * c

    def lamb(x):
        def rate(s):  # lambda = e^s
            u = np.exp(s)
            return u / ((x * x + u) * np.sqrt((a * a + u) * (b * b + u) * (c * c + u)))

        return a * b * c * quad(rate, -40, 40, limit=500)[0]

    alpha = [lamb(x) for x in axes]

    def rotation(p, q, of_p, of_q):
        if p == q:
            return 0.0
        apart, both = p * p - q * q, p * p + q * q
        return volume / 5 * apart**2 * (of_q - of_p) / (2 * apart + both * (of_p - of_q))

    turned = [rotation(axes[i - 2], axes[i - 1], alpha[i - 2], alpha[i - 1]) for i in range(3)]
    return np.array([volume * x / (2 - x) for x in alpha] + turned)


def write_stl(file, triangles, binary=False):
    """A file of triangles (k,3,3)."""
    if binary:
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        rows = np.zeros(len(triangles), record)
        rows["corners"] = triangles
        file.write_bytes(b"solid binary".ljust(80) + len(triangles).to_bytes(4, "little") + rows.tobytes())
        return
    lines = ["solid hull"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(f"{x:.9g}" for x in corner) for corner in triangle]
        lines += ["endloop", "endfacet"]
    file.write_text("\n".join([*lines, "endsolid hull"]) + "\n")


def cylinder(length, sides):
    """Triangles of a cylinder along x, with the volume of the round one of diameter 1."""
    angle = np.arange(sides) * 2 * np.pi / sides
    radius = 0.5 * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    ring = np.stack([np.zeros(sides), radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    end = np.array([length / 2, 0, 0])
    triangles = []
    for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        triangles += [(q + end, q - end, p - end), (p + end, q + end, p - end)]
        triangles += [(end, p + end, q + end), (-end, q - end, p - end)]
    return np.array(triangles)
