"""The force of the water on a fin: lift and drag of a foil that a servo turns, in the flow its hull makes at it.

The place of a fin is where its lift acts, a quarter of the chord behind its leading edge. Its flow is the velocity of
that place through the water, rotation of the hull included; what flows along the span counts for nothing. With u along
the chord and n along the normal, a deflection delta makes the angle of attack

    alpha = delta - atan2(n, u):

positive, the leading edge is turned towards the normal, and the fin is pushed there.

Source: attached flow C_L = a alpha, C_D = C_D0 + C_L^2 / (pi e AR) (L. Prandtl's lifting line); separated flow the
normal force of a flat plate, C_L = 2 sin^2 alpha cos alpha; both blended about the angle of stall as in R. W. Beard and
T. W. McLain, Small Unmanned Aircraft (2012), section 4.2.3.
"""

from __future__ import annotations

from math import atan2, cos, exp, inf, pi, sin, sqrt

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, dot, plus, stacked, times

HULL, PLACE, CHORD, NORMAL, HALF_DENSITY_AREA, SLOPE = 0, 1, 4, 7, 10, 11
STALL, DRAG, INDUCED, SERVO = 12, 13, 14, 15
"""Columns of a table of fins, a row each.

Number of the hull; place (3) from the body origin [m], and the unit vectors along the chord, ahead, and along the
normal (3 each), all in body axes; rho S / 2 [kg/m]; lift slope a [1/rad]; angle of stall [rad], infinite for the linear
form; C_D0; 1 / (pi e AR); and where the deflection [rad] lies among the activations of the model, -1 for a fixed fin.
"""
COLUMNS = 16

_SHARPNESS = 50.0
"""How fast a fin stalls [1/rad]: in 4 degrees about its angle of stall (a choice)."""


@compiled
def coefficients(angle, slope, stall, drag, induced):
    """(C_L, C_D) at an angle of attack [rad] between -pi and pi; the other arguments as in the table."""
    attached = 1.0 / ((1.0 + exp(_SHARPNESS * (angle - stall))) * (1.0 + exp(-_SHARPNESS * (angle + stall))))
    lift = slope * angle
    plate = 2.0 * abs(sin(angle)) * sin(angle)
    return (
        attached * lift + (1.0 - attached) * plate * cos(angle),
        drag + attached * induced * lift * lift + (1.0 - attached) * plate * sin(angle),
    )


@compiled
def foil_force(fin, deflection, u, n):
    """The force along chord and normal, a pair [N].

    In the linear form, that of tables of manoeuvring derivatives, it is rho S/2 a |u| (u delta - n) along the normal.

    Args:
        fin: (`COLUMNS`,) row of the table.
        deflection: [rad].
        u: speed through the water along the chord [m/s].
        n: along the normal [m/s].
    """
    half = fin[HALF_DENSITY_AREA]
    if fin[STALL] == inf:
        return 0.0, half * fin[SLOPE] * abs(u) * (u * deflection - n)
    speed = sqrt(u * u + n * n)
    if speed == 0.0:
        return 0.0, 0.0
    angle = deflection - atan2(n, u)
    if angle > pi:
        angle -= 2.0 * pi
    elif angle < -pi:
        angle += 2.0 * pi
    lift, drag = coefficients(angle, fin[SLOPE], fin[STALL], fin[DRAG], fin[INDUCED])
    return -half * speed * (drag * u + lift * n), half * speed * (lift * u - drag * n)


@compiled
def fin_wrench(fin, deflection, nu_r):
    """The wrench of a fin in body axes at the body origin, a 6-tuple [N, N m].

    Args:
        fin: (`COLUMNS`,) row of the table.
        deflection: [rad].
        nu_r: relative velocity of the hull, a 6-tuple, body axes [m/s, rad/s].
    """
    place = (fin[PLACE], fin[PLACE + 1], fin[PLACE + 2])
    chord = (fin[CHORD], fin[CHORD + 1], fin[CHORD + 2])
    normal = (fin[NORMAL], fin[NORMAL + 1], fin[NORMAL + 2])
    flow = plus(nu_r[:3], cross_tuples(nu_r[3:], place))
    along, across = foil_force(fin, deflection, dot(chord, flow), dot(normal, flow))
    force = plus(times(along, chord), times(across, normal))
    return stacked(force, cross_tuples(place, force))


@compiled
def attached_wrench(fin, nu_r):
    """The wrench of a fin that is not deflected, did it never stall, a 6-tuple [N, N m], body axes at the body origin.

    -rho S/2 |u| (a n along the normal + C_D0 u along the chord), as hulls reckon with it (`cube_sim.vehicle.lift`): |u|
    is that of the hull, along the axis of the body that is nearest to the chord.

    Args:
        fin: as in `fin_wrench`, like the next.
        nu_r: see there.
    """
    place = (fin[PLACE], fin[PLACE + 1], fin[PLACE + 2])
    chord = (fin[CHORD], fin[CHORD + 1], fin[CHORD + 2])
    normal = (fin[NORMAL], fin[NORMAL + 1], fin[NORMAL + 2])
    x, y, z = abs(chord[0]), abs(chord[1]), abs(chord[2])
    ahead = x * abs(nu_r[0]) if x >= y and x >= z else (y * abs(nu_r[1]) if y >= z else z * abs(nu_r[2]))
    half, flow = fin[HALF_DENSITY_AREA] * ahead, plus(nu_r[:3], cross_tuples(nu_r[3:], place))
    along, across = -half * fin[DRAG] * dot(chord, flow), -half * fin[SLOPE] * dot(normal, flow)
    force = plus(times(along, chord), times(across, normal))
    return stacked(force, cross_tuples(place, force))


@compiled
def servo_rate(target, deflection, lag_s, limit):
    """How fast a servo turns its fin [rad/s]: towards its target with a lag, no faster than its limit.

    Args:
        target: [rad].
        deflection: [rad].
        lag_s: time constant [s].
        limit: fastest rate [rad/s].
    """
    return min(max((target - deflection) / lag_s, -limit), limit)
