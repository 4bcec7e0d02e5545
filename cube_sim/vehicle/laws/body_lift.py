"""The force of the water on a hull at an angle to its flow: body lift by derivatives, cross-flow drag by strips.

Both are for slender hulls. Manoeuvring derivatives are products of two velocities, F_i = c nu_j nu_k or c nu_j |nu_k|.
Cross-flow drag is that of the strips the hull is cut into, each in the flow across it.

Source: A. J. Healey and D. Lienard, Multivariable sliding-mode control for autonomous diving and steering of unmanned
underwater vehicles, IEEE J. Oceanic Eng. 18 (1993), appendix.
"""

from __future__ import annotations

from math import sqrt

from cube_sim.native.compiled import compiled
from cube_sim.tuples import component

HULL, AXIS, FIRST, SECOND, ABSOLUTE, COEFFICIENT = 0, 1, 2, 3, 4, 5
"""Columns of a table of products: number of the hull; axis of the force, and of either velocity, 0 to 5; 1 where the
second is taken without its sign, else 0; and the coefficient [N] / [m/s, rad/s]^2, about an axis [N m]."""
PRODUCT_COLUMNS = 6

STATION, SIDEWAYS, UPWARDS = 1, 2, 3
"""Columns of a table of strips, behind the number of the hull: x of the strip in body axes [m]; rho/2 C_D A [kg/m] of
its area across y, and across z."""
STRIP_COLUMNS = 4


@compiled
def products_wrench(products, hull, nu_r):
    """The wrench of a hull's products of velocities, a 6-tuple [N, N m], body axes.

    Args:
        products: (n, `PRODUCT_COLUMNS`) their table.
        hull: number of the hull.
        nu_r: relative velocity, a 6-tuple, body axes [m/s, rad/s].
    """
    fx, fy, fz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for row in range(products.shape[0]):
        p = products[row]
        if p[HULL] != hull:
            continue
        second = component(nu_r, p[SECOND])
        if p[ABSOLUTE] != 0.0:
            second = abs(second)
        force = p[COEFFICIENT] * component(nu_r, p[FIRST]) * second
        axis = int(p[AXIS])
        if axis == 0:
            fx += force
        elif axis == 1:
            fy += force
        elif axis == 2:
            fz += force
        elif axis == 3:
            mx += force
        elif axis == 4:
            my += force
        else:
            mz += force
    return (fx, fy, fz, mx, my, mz)


@compiled
def deflected_wrench(linear, square, fin, deflection, nu_r):
    """The wrench of the products of velocities and a fin's deflection, a 6-tuple [N, N m], body axes.

    Args:
        linear: (n, `PRODUCT_COLUMNS`) products with the deflection, the number of the fin in the hull's place.
        square: (n, `PRODUCT_COLUMNS`) products with its square.
        fin: number of the fin.
        deflection: [rad].
        nu_r: relative velocity, a 6-tuple, body axes [m/s, rad/s].
    """
    a, b = products_wrench(linear, fin, nu_r), products_wrench(square, fin, nu_r)
    return (
        deflection * (a[0] + deflection * b[0]),
        deflection * (a[1] + deflection * b[1]),
        deflection * (a[2] + deflection * b[2]),
        deflection * (a[3] + deflection * b[3]),
        deflection * (a[4] + deflection * b[4]),
        deflection * (a[5] + deflection * b[5]),
    )


@compiled
def strips_wrench(strips, hull, nu_r):
    """The wrench of the flow across a hull, a 6-tuple [N, N m], body axes.

    A strip at x meets the water with v + x r and w - x q; its drag per area is along that flow, and grows with C_D and
    its area as seen from the side and from above.

    Args:
        strips: (n, `STRIP_COLUMNS`) their table.
        hull: number of the hull.
        nu_r: relative velocity, a 6-tuple, body axes [m/s, rad/s].
    """
    fy, fz, my, mz = 0.0, 0.0, 0.0, 0.0
    for row in range(strips.shape[0]):
        s = strips[row]
        if s[HULL] != hull:
            continue
        x = s[STATION]
        v, w = nu_r[1] + x * nu_r[5], nu_r[2] - x * nu_r[4]
        speed = sqrt(v * v + w * w)
        if speed == 0.0:
            continue
        pressed = (s[SIDEWAYS] * v * v + s[UPWARDS] * w * w) / speed
        fy -= pressed * v
        fz -= pressed * w
        my += x * pressed * w
        mz -= x * pressed * v
    return (0.0, fy, fz, 0.0, my, mz)
