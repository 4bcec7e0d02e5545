"""Variable ballast: a bladder that displaces more water, or a tank that takes water in.

A volume V, the state of a pump with a rate limit, is away from what hull:volume and the hull's mass count. With alpha
the share of it that the hull displaces more, beta the mass [kg/m^3] that comes in with it, and r its place,

    f = (alpha rho S - beta) V (-g) - beta V w x (w x r) - beta max(V', 0) (v + w x r - v_c)

acts there: lift, which fades with the surface by S, and weight, which does not; what the mass takes to turn with the
hull; and the momentum of the water that comes in at rest in the current. What is pumped out leaves at the hull's own
velocity, without a jet. The mass beta V is in the inertia, by `tank_inertia`. A bladder changes nothing of the added
mass.

Source: momentum of a body of variable mass, m v' = F + m' (u - v), u that of what comes in (A. Cayley 1857).
"""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, plus, stacked, times

HULL, PLACE, LIFT, DENSITY, STATE, ACTUATOR, SITE = 0, 1, 4, 5, 6, 7, 8
"""Columns of a table of ballast, a row each.

Number of the hull; place (3) from the body origin in body axes [m]; alpha rho and beta [kg/m^3]; where V lies among the
activations; its actuator; its site.
"""
COLUMNS = 9


@compiled
def ballast_wrench(row, volume, rate, share, down, nu, nu_r):
    """The wrench of one of them in body axes at the body origin, a 6-tuple [N, N m].

    Args:
        row: (`COLUMNS`,) of the table.
        volume: V [m^3].
        rate: V' [m^3/s].
        share: of its site that is under water.
        down: gravity in body axes, a 3-tuple [m/s^2].
        nu: velocity of the hull over ground, a 6-tuple, body axes [m/s, rad/s].
        nu_r: through the water.
    """
    place = (row[PLACE], row[PLACE + 1], row[PLACE + 2])
    mass, w = row[DENSITY] * volume, nu[3:]
    force = times(mass - row[LIFT] * share * volume, down)
    if row[DENSITY] > 0.0:
        force = plus(force, times(-mass, cross_tuples(w, cross_tuples(w, place))))
        if rate > 0.0:
            flow = plus(nu_r[:3], cross_tuples(w, place))
            force = plus(force, times(-row[DENSITY] * rate, flow))
    return stacked(force, cross_tuples(place, force))


@compiled
def tank_inertia(row, volume, i, j):
    """Element i, j of the inertia (6,6) of what is in a tank, a point mass, at the body origin [kg, kg m, kg m^2].

    Args:
        row: (`COLUMNS`,) of the table.
        volume: V [m^3].
        i: 0 to 5.
        j: likewise.
    """
    mass, x, y, z = row[DENSITY] * volume, row[PLACE], row[PLACE + 1], row[PLACE + 2]
    if i > j:
        i, j = j, i
    if j < 3:
        return mass if i == j else 0.0
    if i < 3:  # -m S(r)
        if i == 0:
            return mass * z if j == 4 else (-mass * y if j == 5 else 0.0)
        if i == 1:
            return -mass * z if j == 3 else (mass * x if j == 5 else 0.0)
        return mass * y if j == 3 else (-mass * x if j == 4 else 0.0)
    if i == j:  # -m S(r) S(r)
        square = y * y + z * z if i == 3 else (x * x + z * z if i == 4 else x * x + y * y)
        return mass * square
    if i == 3:
        return -mass * x * y if j == 4 else -mass * x * z
    return -mass * y * z
