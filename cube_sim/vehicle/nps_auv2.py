"""The propeller's race on the hull of NPS AUV II, named by models/nps_auv2.xml.

Where the propeller turns faster than belongs to the speed, its race makes hull and stern planes do more; slower, less.
Healey and Lienard (1993, appendix) have terms in epsilon(n) for that, which are 0 at the speed that belongs to the
revolutions:

    eta = 0.012 n / u        C_t = 0.008 L^2 eta |eta| / 2        C_t1 = 0.008 L^2 / 2
    epsilon = -1 + sign(n) (sqrt(C_t + 1) - 1) / (sqrt(C_t1 + 1) - 1)

as T. I. Fossen's Marine Systems Simulator writes them (npsauv), n in rad/s. Every term holds u epsilon, which is finite
at u = 0. Astern, where the square root has no value, the race is as at u = 0 (a choice).
"""

from __future__ import annotations

from math import sqrt

L = 5.3  # [m]
R2, R3, R4 = 500.0 * L**2, 500.0 * L**3, 500.0 * L**4  # rho/2 L^k
SPEED = 0.012 * 1500.0 / 60.0 * 6.283185307179586  # 0.012 n at command 1 [m/s]
C_T1 = 0.008 * L**2 / 2.0
X_QDSN, X_WDSN, X_DSDSN = 2.0e-3, 3.5e-3, -1.6e-3
Z_QN, Z_WN, Z_DSN = -2.9e-3, -5.1e-3, -1.0e-2
K_PN = -5.7e-4
M_QN, M_WN, M_DSN = -1.6e-3, -2.9e-3, -5.2e-3
PROPELLER, STERN_PLANES = 0, 2  # among the actuators of its file


def race(time, position, rotation, velocity, through_water, command, activation):
    """Wrench in body axes (6,) [N, N m] of the race; velocities through the water, FLU: w and q have the other sign."""
    u, w, p, q = max(through_water[0], 0.0), through_water[2], through_water[3], through_water[4]
    turned, delta = SPEED * activation[PROPELLER], activation[STERN_PLANES]
    sign = 1.0 if turned > 0.0 else -1.0 if turned < 0.0 else 0.0
    outflow = sqrt(max(C_T1 * turned * abs(turned) + u * u, 0.0))
    more = -u + sign * (outflow - u) / (sqrt(C_T1 + 1.0) - 1.0)  # u epsilon
    surge = R2 * (-X_WDSN * w + X_DSDSN * u * delta) * delta - R3 * X_QDSN * q * delta
    heave = R3 * Z_QN * q + R2 * (Z_WN * w - Z_DSN * u * delta)
    pitch = R4 * M_QN * q + R3 * (M_WN * w - M_DSN * u * delta)
    return more * surge, 0.0, more * heave, more * R4 * K_PN * p, more * pitch, 0.0
