"""Lift of the INFANTE-class AUV: the products of velocities in its planar model, named by models/infante.xml.

The published planar equations hold u v and u r terms that are neither added mass nor drag, and leave out the v r term
of surge. This force is what makes the whole hull obey those equations; the constants are the model file's, and a test
holds the compiled model to the equations.

These derivatives were fitted to a vehicle that goes ahead. Astern, u < 0, the same products put energy into yaw and
sway instead of taking it out: the model is for u > 0.
"""

from __future__ import annotations

MASS = 2234.5  # [kg]
X_UDOT, Y_VDOT = -141.9, -1715.4  # added mass, with the minus of the literature [kg]
Y_UV, Y_UR = -346.76, 103.4  # [kg/m], [kg]
N_UV, N_UR = -686.08, -1427.0  # [kg], [kg m]


def planar_lift(time, position, rotation, velocity, through_water):
    """Wrench in body axes (6,) [N, N m] that turns Kirchhoff's planar terms into the published ones.

    The rigid body and the added mass bring  X: (m - Yvdot) v r,  Y: -(m - Xudot) u r,  N: (Yvdot - Xudot) u v;  the
    published model has  X: 0,  Y: -(m - Yur) u r + Yuv u v,  N: Nuv u v + Nur u r.  Velocities through the water.
    """
    u, v, r = through_water[0], through_water[1], through_water[5]
    surge = -(MASS - Y_VDOT) * v * r
    sway = (Y_UR - X_UDOT) * u * r + Y_UV * u * v
    yaw = (N_UV - Y_VDOT + X_UDOT) * u * v + N_UR * u * r
    return surge, sway, 0.0, 0.0, 0.0, yaw
