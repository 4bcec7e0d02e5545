"""What sources on plane triangles make at points, in closed form, compiled.

A triangle has the unit normal n. Seen from a point x, its edge i has the unit tangent t_i, the normal u_i in the plane,
outwards, ends at the distances r_i and r_i+1, the foot f_i of the perpendicular from x, and

    L_i = integral of 1/r along the edge = ln((r_i + r_i+1 + l_i)/(r_i + r_i+1 - l_i)),   U = sum of u_i L_i

h is the height of the plane over x along n, d_i = u_i . (f_i - x), O the solid angle, positive seen from behind. Then,
over the triangle,

    P = integral of 1/r            = sum of d_i L_i - h O              its gradient is  G = O n - U
    Y = integral of y/r            = x P + half the sum of u_i (|f_i - x|^2 L_i + s_i+1 r_i+1 - s_i r_i),  in the plane

with s_i, s_i+1 the places of the ends along t_i from the foot. A source of strength c . y has the potential c . Y, and
along a direction m that grows as c . Z, for any c in the plane:

    Z = P m - sum of (m . u_i) (f_i L_i + t_i (r_i+1 - r_i)) + (m . n) (O x - h U)

(J. L. Hess and A. M. O. Smith, J. Ship Research 8, 1964; D. R. Wilton et al., IEEE Trans. Antennas Propag. 32, 1984,
for linear sources; A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30, 1983, for the solid angle.)
"""

from __future__ import annotations

from math import atan2, log, pi, sqrt

import numpy as np

from cube_sim.native.compiled import compiled, unlocked

_FAR_SQUARED = 400.0
"""Beyond 20 times the larger radius both triangles are points: a thousandth of a share is lost, of either sign."""
_NEAR_SQUARED, _TOUCHING_SQUARED = 25.0, 4.0
"""Within 5 times it the outer integral takes seven points, beyond it three, within twice 28 (choices)."""


def _rules() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of corners' shares and weight: of degree 2, of degree 5, and that on each of four quarters."""
    three = np.array([[2 / 3, 1 / 6, 1 / 6, 1 / 3], [1 / 6, 2 / 3, 1 / 6, 1 / 3], [1 / 6, 1 / 6, 2 / 3, 1 / 3]])
    root = sqrt(15.0)
    seven = [np.array([1 / 3, 1 / 3, 1 / 3, 9 / 40])]
    for sign in (-1.0, 1.0):
        share, weight = (6.0 + sign * root) / 21.0, (155.0 + sign * root) / 1200.0
        seven += [np.append(np.roll([1.0 - 2.0 * share, share, share], i), weight) for i in range(3)]
    of_whole = np.array(seven)  # J. Radon, Monatsh. Math. Phys. 52, 1948
    corners, middles = np.eye(3), 0.5 * (np.eye(3) + np.roll(np.eye(3), -1, axis=0))
    quarters = [np.stack([corners[i], middles[i], middles[i - 1]]) for i in range(3)] + [middles]
    finest = [np.column_stack([of_whole[:, :3] @ quarter, of_whole[:, 3] / 4.0]) for quarter in quarters]
    return three, of_whole, np.concatenate(finest)


THREE, SEVEN, QUARTERED = _rules()


@compiled
def of_triangle(x, y, z, corners, n, m, Y, Z):  # type: ignore[no-untyped-def]
    """(P, m . G) of one triangle at a point that is not on its rim; Y and Z are filled.

    Args:
        x: of the point.
        y: of it.
        z: of it.
        corners: (3,3) of the triangle.
        n: (3,) its unit normal.
        m: (3,) the direction of the gradient.
        Y: (3,), filled.
        Z: (3,), filled.
    """
    nx, ny, nz = n[0], n[1], n[2]
    ax, ay, az = corners[0, 0] - x, corners[0, 1] - y, corners[0, 2] - z
    bx, by, bz = corners[1, 0] - x, corners[1, 1] - y, corners[1, 2] - z
    cx, cy, cz = corners[2, 0] - x, corners[2, 1] - y, corners[2, 2] - z
    la = sqrt(ax * ax + ay * ay + az * az)
    lb = sqrt(bx * bx + by * by + bz * bz)
    lc = sqrt(cx * cx + cy * cy + cz * cz)
    P, Ux, Uy, Uz, Yx, Yy, Yz, Zx, Zy, Zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for e in range(3):
        if e == 0:
            px, py, pz, qx, qy, qz, r, R = ax, ay, az, bx, by, bz, la, lb
        elif e == 1:
            px, py, pz, qx, qy, qz, r, R = bx, by, bz, cx, cy, cz, lb, lc
        else:
            px, py, pz, qx, qy, qz, r, R = cx, cy, cz, ax, ay, az, lc, la
        tx, ty, tz = qx - px, qy - py, qz - pz
        length = sqrt(tx * tx + ty * ty + tz * tz)
        tx, ty, tz = tx / length, ty / length, tz / length
        ux, uy, uz = ty * nz - tz * ny, tz * nx - tx * nz, tx * ny - ty * nx
        around, beyond = r + R + length, r + R - length
        L = log(around / max(beyond, 1e-14 * around))
        s = px * tx + py * ty + pz * tz
        S = s + length
        fx, fy, fz = px - s * tx, py - s * ty, pz - s * tz
        P += (px * ux + py * uy + pz * uz) * L
        Ux, Uy, Uz = Ux + ux * L, Uy + uy * L, Uz + uz * L
        first = 0.5 * ((fx * fx + fy * fy + fz * fz) * L + S * R - s * r)
        Yx, Yy, Yz = Yx + ux * first, Yy + uy * first, Yz + uz * first
        mu, D = m[0] * ux + m[1] * uy + m[2] * uz, R - r
        Zx -= mu * ((fx + x) * L + tx * D)
        Zy -= mu * ((fy + y) * L + ty * D)
        Zz -= mu * ((fz + z) * L + tz * D)
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    below = (
        la * lb * lc
        + (ax * bx + ay * by + az * bz) * lc
        + (bx * cx + by * cy + bz * cz) * la
        + (cx * ax + cy * ay + cz * az) * lb
    )
    h = ax * nx + ay * ny + az * nz
    angle = 2.0 * atan2(triple, below) if h != 0.0 else 0.0
    P -= h * angle
    mn = m[0] * nx + m[1] * ny + m[2] * nz
    Y[0], Y[1], Y[2] = Yx + x * P, Yy + y * P, Yz + z * P
    Z[0] = Zx + P * m[0] + mn * (angle * x - h * Ux)
    Z[1] = Zy + P * m[1] + mn * (angle * y - h * Uy)
    Z[2] = Zz + P * m[2] + mn * (angle * z - h * Uz)
    return P, mn * angle - (m[0] * Ux + m[1] * Uy + m[2] * Uz)


@compiled
def side(corners, e):  # type: ignore[no-untyped-def]
    """Length of the side from corner e of a triangle (3,3) to the next."""
    f = (e + 1) % 3
    return sqrt(
        (corners[f, 0] - corners[e, 0]) ** 2
        + (corners[f, 1] - corners[e, 1]) ** 2
        + (corners[f, 2] - corners[e, 2]) ** 2
    )


@compiled
def own_integral(corners, area):  # type: ignore[no-untyped-def]
    """Integral of 1/r, both points on one triangle (T. F. Eibert, V. Hansen, IEEE Trans. Antennas Propag. 43, 1995).

    Args:
        corners: (3,3) of it.
        area: of it.
    """
    around, total = 0.0, 0.0
    for e in range(3):
        around += side(corners, e)
    for e in range(3):
        length = side(corners, e)
        total -= log(max(1.0 - 2.0 * length / around, 1e-14)) / length
    return 4.0 / 3.0 * area * area * total


@unlocked
def linear_panels(triangles, normals, areas, three, seven, quartered, V, W, flux):  # type: ignore[no-untyped-def]
    """Fill the integrals of Galerkin's method for the six motions of a rigid body.

    v_n of surge, sway and heave at y is n, of roll, pitch and yaw y x n: linear on a triangle, and exact.

    Args:
        triangles: (k,3,3) corners.
        normals: (k,3) unit, into the water.
        areas: (k,).
        three: `THREE`.
        seven: `SEVEN`.
        quartered: `QUARTERED`.
        V: (k,k), filled: integral over both triangles of G = 1/(4 pi r).
        W: (6,6), filled: integral over the surface, twice, of v_n,i G v_n,j.
        flux: (k,3,6), filled: integral over a triangle of one corner's linear function times K'v_n, the velocity along
            the normal that sources v_n on all triangles make, beside v_n/2.
    """
    quarter = 1.0 / (4.0 * pi)
    k = triangles.shape[0]
    middle, reach = np.zeros((k, 3)), np.zeros(k)
    for i in range(k):
        for d in range(3):
            middle[i, d] = (triangles[i, 0, d] + triangles[i, 1, d] + triangles[i, 2, d]) / 3.0
        for c in range(3):
            away = 0.0
            for d in range(3):
                away += (triangles[i, c, d] - middle[i, d]) ** 2
            reach[i] = max(reach[i], away)
    Y, Z = np.zeros(3), np.zeros(3)
    touching, through, near = np.zeros(k, np.int64), np.zeros(k), np.zeros((k, 3, 6))
    at_all, of_source, by_corner, v = np.zeros((k, 6)), np.zeros((6, 4)), np.zeros((3, 4)), np.zeros(6)
    for i in range(6):
        for j in range(6):
            W[i, j] = 0.0
    for i in range(k):
        for c in range(3):
            for j in range(6):
                flux[i, c, j] = 0.0
    for s in range(k):
        nx, ny, nz = normals[s, 0], normals[s, 1], normals[s, 2]
        neighbours, passed, weighed = 0, 0.0, 0.0
        for r in range(6):  # of v_n,r at the other points: times P, times the three of Y
            for d in range(4):
                of_source[r, d] = 0.0
        for i in range(k):
            n = normals[i]
            mx, my, mz = middle[i, 0], middle[i, 1], middle[i, 2]
            dx, dy, dz = middle[s, 0] - mx, middle[s, 1] - my, middle[s, 2] - mz
            squared = dx * dx + dy * dy + dz * dz
            larger = max(reach[i], reach[s])
            v[0], v[1], v[2] = n[0], n[1], n[2]
            if squared > _FAR_SQUARED * larger:
                P = quarter * areas[i] * areas[s] / sqrt(squared)
                V[s, i] = P
                grown = P * (dx * n[0] + dy * n[1] + dz * n[2]) / squared
                passed += grown
                v[3], v[4], v[5] = my * n[2] - mz * n[1], mz * n[0] - mx * n[2], mx * n[1] - my * n[0]
                for r in range(6):  # where a source is a point, Y is its place times P, and Z likewise
                    of_source[r, 0] += v[r] * P
                    of_source[r, 1] += v[r] * P * middle[s, 0]
                    of_source[r, 2] += v[r] * P * middle[s, 1]
                    of_source[r, 3] += v[r] * P * middle[s, 2]
                at_all[i, 0] += nx * grown
                at_all[i, 1] += ny * grown
                at_all[i, 2] += nz * grown
                at_all[i, 3] += (middle[s, 1] * nz - middle[s, 2] * ny) * grown
                at_all[i, 4] += (middle[s, 2] * nx - middle[s, 0] * nz) * grown
                at_all[i, 5] += (middle[s, 0] * ny - middle[s, 1] * nx) * grown
                continue
            touches = squared < _TOUCHING_SQUARED * larger
            rule = quartered if touches else seven if squared < _NEAR_SQUARED * larger else three
            for c in range(3):
                for d in range(4):
                    by_corner[c, d] = 0.0
            total = 0.0
            for g in range(rule.shape[0]):
                a, b, c, weight = rule[g, 0], rule[g, 1], rule[g, 2], rule[g, 3] * areas[i] * quarter
                x = a * triangles[i, 0, 0] + b * triangles[i, 1, 0] + c * triangles[i, 2, 0]
                y = a * triangles[i, 0, 1] + b * triangles[i, 1, 1] + c * triangles[i, 2, 1]
                z = a * triangles[i, 0, 2] + b * triangles[i, 1, 2] + c * triangles[i, 2, 2]
                P, grown = of_triangle(x, y, z, triangles[s], normals[s], n, Y, Z)
                P, grown = weight * P, weight * grown
                total += P
                v[3], v[4], v[5] = y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]
                for r in range(6):
                    of_source[r, 0] += v[r] * P
                    for d in range(3):
                        of_source[r, 1 + d] += v[r] * weight * Y[d]
                for corner in range(3):
                    share = rule[g, corner]
                    by_corner[corner, 0] += share * grown
                    for d in range(3):
                        by_corner[corner, 1 + d] += share * weight * Z[d]
            if s == i:
                V[s, i] = quarter * own_integral(triangles[i], areas[i])
                continue  # a plane makes no velocity along its own normal
            V[s, i] = total
            out = by_corner[0, 0] + by_corner[1, 0] + by_corner[2, 0]
            passed += out
            of = flux[i]
            if touches:
                of = near[neighbours]
                touching[neighbours], through[neighbours] = i, out
                neighbours += 1
                weighed += abs(out)
            for c in range(3):
                zx, zy, zz = by_corner[c, 1], by_corner[c, 2], by_corner[c, 3]
                if touches:
                    for j in range(6):
                        of[c, j] = 0.0
                of[c, 0] += nx * by_corner[c, 0]
                of[c, 1] += ny * by_corner[c, 0]
                of[c, 2] += nz * by_corner[c, 0]
                of[c, 3] += zy * nz - zz * ny
                of[c, 4] += zz * nx - zx * nz
                of[c, 5] += zx * ny - zy * nx
        for r in range(6):
            yx, yy, yz = of_source[r, 1], of_source[r, 2], of_source[r, 3]
            W[r, 0] += of_source[r, 0] * nx
            W[r, 1] += of_source[r, 0] * ny
            W[r, 2] += of_source[r, 0] * nz
            W[r, 3] += yy * nz - yz * ny
            W[r, 4] += yz * nx - yx * nz
            W[r, 5] += yx * ny - yy * nx
        # Half of what a source on the surface gives goes inside, and through the other triangles: exactly. What is
        # missing of it was lost near the rims they share, where the velocity grows like a logarithm.
        missing = -0.5 * areas[s] - passed
        for t in range(neighbours):
            factor = 1.0
            if weighed > 0.0 and through[t] != 0.0:
                factor += missing * abs(through[t]) / (weighed * through[t])
            for c in range(3):
                for j in range(6):
                    flux[touching[t], c, j] += factor * near[t, c, j]
    for i in range(k):
        for c in range(3):
            for j in range(6):
                flux[i, c, j] += at_all[i, j] / 3.0
