"""What is left of the water's forces on a hull that comes out of the water, written once.

The displaced volume is spread evenly over an ellipsoid about the centre of buoyancy, its axes the body's. The surface
is a horizontal plane. Let the centre lie at the depth t, in units of the ellipsoid's half extent along the vertical.
What is below the plane has

    the share     S(t) = (1 + t)^2 (2 - t) / 4 of the volume,
    its centroid  at r_CB - 3 (1 - t)^2 / (4 (2 - t)) q,   q = A^2 u / w,

with A the half-axes, u the vertical in body axes and w = |A u| the half extent: the cap of a sphere, stretched.
Buoyancy S rho V g at that centroid has a potential, rho g times the depth summed over all that is under water.
Stiffness of heave and metacentric moments follow from it; nothing is added for them.

Added mass, drag and lift fade with the same share S. So the kinetic energy of the water is S T_0, T_0 = nu_r' M_A nu_r
/ 2, and Lagrange's equations have two terms more than with an M_A that stays (as near a wall: Lamb 1932, chapter VI):
what the change of the momentum takes, and the derivative of the energy by the place,

    -S' M_A nu_r + T_0 g,   S' = g nu,   g = -(dS/dt / w) [u; (r_CB + t q) x u]:

a force along the vertical at the centre of the waterplane. Together they do no work that is not stored: without drag
the energy of a hull that bobs stays. Waves, which would take some, are not modelled, nor is spray.
"""

from __future__ import annotations

from math import sqrt

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, dot


@compiled
def share_of_depth(depth, radius):
    """Share of the volume of a sphere that is under water; of a thruster that fades with it.

    Args:
        depth: of its centre below the surface [m].
        radius: [m].
    """
    if depth >= radius:
        return 1.0
    if depth <= -radius:
        return 0.0
    t = depth / radius
    return 0.25 * (1.0 + t) * (1.0 + t) * (2.0 - t)


@compiled
def hull_under_water(depth, up, half_axes, r_CB):
    """What of a hull is under water.

    Args:
        depth: of the centre of buoyancy of the whole hull below the surface [m].
        up: world up in body axes, a 3-tuple.
        half_axes: of its ellipsoid, a 3-tuple, along the body's axes [m].
        r_CB: centre of buoyancy of the whole hull, a 3-tuple, body axes [m].

    Returns:
        The share of the volume, the centre of that share (a 3-tuple, body axes [m]), and g: the derivative of the share
        by a small motion in body axes, a 6-tuple [1/m, 1/rad].
    """
    ax, ay, az = half_axes[0] * up[0], half_axes[1] * up[1], half_axes[2] * up[2]
    w = sqrt(ax * ax + ay * ay + az * az)
    t = depth / w
    share = share_of_depth(depth, w)
    if t >= 1.0 or t <= -1.0:
        return share, r_CB, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    q = (half_axes[0] * ax / w, half_axes[1] * ay / w, half_axes[2] * az / w)
    below = -0.75 * (1.0 - t) * (1.0 - t) / (2.0 - t)
    centre = (r_CB[0] + below * q[0], r_CB[1] + below * q[1], r_CB[2] + below * q[2])
    slope = -0.75 * (1.0 - t * t) / w
    moment = cross_tuples((r_CB[0] + t * q[0], r_CB[1] + t * q[1], r_CB[2] + t * q[2]), up)
    return (
        share,
        centre,
        (slope * up[0], slope * up[1], slope * up[2], slope * moment[0], slope * moment[1], slope * moment[2]),
    )


@compiled
def faded(share, wrench):
    """A share of a wrench, a 6-tuple."""
    return (
        share * wrench[0],
        share * wrench[1],
        share * wrench[2],
        share * wrench[3],
        share * wrench[4],
        share * wrench[5],
    )


@compiled
def fading_wrench(momentum, gradient, nu, nu_r):
    """-S' M_A nu_r + T_0 g [N, N m], a 6-tuple in body axes at the body origin: what comes of added mass that fades.

    Args:
        momentum: M_A nu_r of the whole hull [kg m/s, kg m^2/s], a 6-tuple like all.
        gradient: g of `hull_under_water`.
        nu: velocity over ground, body axes [m/s, rad/s].
        nu_r: velocity relative to the water.
    """
    rate = dot(gradient[:3], nu[:3]) + dot(gradient[3:], nu[3:])
    energy = 0.5 * (dot(momentum[:3], nu_r[:3]) + dot(momentum[3:], nu_r[3:]))
    return (
        energy * gradient[0] - rate * momentum[0],
        energy * gradient[1] - rate * momentum[1],
        energy * gradient[2] - rate * momentum[2],
        energy * gradient[3] - rate * momentum[3],
        energy * gradient[4] - rate * momentum[4],
        energy * gradient[5] - rate * momentum[5],
    )
