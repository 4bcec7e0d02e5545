"""What a sensor should read of a motion, and how that reading changes with the motion, for every kind of sensor."""

from __future__ import annotations

from math import pi

from cube_sim.native.compiled import compiled
from cube_sim.navigation.aid import DEPTH, DVL, HEADING, OWN, POSITION
from cube_sim.navigation.depth import depth_reading
from cube_sim.navigation.dvl import dvl_reading
from cube_sim.navigation.heading import heading_reading
from cube_sim.navigation.own_aid import own_reading
from cube_sim.navigation.position import position_reading


@compiled
def expect(aid, constants, position, velocity, R, rates, value, H_motion, H_constants):
    """The reading of a sensor without noise, and the linear part of how it comes about.

    Args:
        aid: element of `cube_sim.navigation.aid.AID`.
        constants: its constant errors, a 4-tuple; those it does not have are not read.
        position: p_WB, a 3-tuple [m], world axes.
        velocity: of the body origin over ground, a 3-tuple [m/s], world axes.
        R: R_WB (3,3).
        rates: w, a 3-tuple [rad/s], body axes.
        value: h (3,), its first n numbers filled.
        H_motion: dh / d[dp, dv, phi, db] (3, 12), its first n rows filled: world position and velocity, rotation vector
            in world axes with R_true = Exp(phi) R, gyro bias, by which the true rates are smaller than they seem.
        H_constants: dh / d constants (3, 4), its first n rows and c columns filled.

    Returns:
        False where the sensor has no reading to give; what is to be filled says nothing then.
    """
    for i in range(3):
        for j in range(12):
            H_motion[i, j] = 0.0
        for j in range(4):
            H_constants[i, j] = 0.0
    if aid.kind == DVL:
        dvl_reading(aid, constants, velocity, R, rates, value, H_motion, H_constants)
    elif aid.kind == DEPTH:
        depth_reading(constants, position, value, H_motion, H_constants)
    elif aid.kind == HEADING:
        return heading_reading(constants, R, value, H_motion, H_constants)
    elif aid.kind == POSITION:
        position_reading(position, value, H_motion)
    elif aid.kind == OWN:
        return own_reading(aid, constants, position, velocity, R, rates, value, H_motion, H_constants)
    else:
        return False
    return True


@compiled
def difference(aid, reading, expected):
    """One component of the innovation, in its unit: a reading less the expected one, an angle the short way round."""
    if aid.kind == HEADING or aid.angle:
        return (reading - expected + pi) % (2.0 * pi) - pi
    return reading - expected
