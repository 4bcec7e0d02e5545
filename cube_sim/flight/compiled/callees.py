"""What the compiled loop calls by its address: each is large, and compiled for those only who fly by it."""

from __future__ import annotations

from functools import cache

import numpy as np

from cube_sim.allocation.fin_shares import FinParts, steer_fins
from cube_sim.control.answering import answer
from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.compiled_parts import resting_law
from cube_sim.control.following import FOLLOWED
from cube_sim.control.planar.steering import resting_planar_law, steer
from cube_sim.guidance.view_record import VIEW
from cube_sim.native.callee import Callee
from cube_sim.navigation.estimating import ERROR, ESTIMATE, NavigationMemory, NavigationParameters, estimate
from cube_sim.navigation.imu import ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import InitialErrors, Navigator
from cube_sim.navigation.reading import READING
from cube_sim.spatial import Record
from cube_sim.vehicle.laws.body_lift import PRODUCT_COLUMNS
from cube_sim.vehicle.laws.fin import COLUMNS


@cache
def nothing_sensed() -> tuple[NavigationParameters, NavigationMemory]:
    """Arguments of `estimate` of the right types, for a flight whose controller sees the true state."""
    still = Motion(np.zeros(3), np.zeros(3), np.eye(3), np.zeros(3))
    known = InitialErrors(0.0, 0.0, 0.0, 0.0)
    return Navigator(ImuErrors(*np.zeros(6).tolist()), (), known, still, 0, np.zeros(3), 1.0).stage(1)


def _records(*kinds: np.dtype) -> tuple[Record, ...]:
    return tuple(np.zeros(1, kind) for kind in kinds)


_ROTATION, _THREE, _FOUR, _SIX = np.eye(3), np.zeros(3), np.zeros(4), np.zeros(6)
_TICK = VIEW, DESIRED, FOLLOWED

ANSWERING = Callee(
    answer,
    lambda: (resting_law(), *_records(*_TICK), _ROTATION, _FOUR, _THREE, _THREE, _SIX, 1.0, 1.0, 0),
)
"""The law for all axes."""

STEERING = Callee(
    steer,
    lambda: (resting_planar_law(), *_records(*_TICK), _ROTATION, _THREE, _THREE, _SIX, 1.0),
)
"""The planar law."""


def no_fins() -> FinParts:
    """Arguments of `steer_fins` of the right types, for a vehicle without fins."""
    pairs, products = np.zeros((0, 2)), np.zeros((0, PRODUCT_COLUMNS))
    fins = np.zeros((0, COLUMNS)), products, products, pairs, np.zeros(0)
    return FinParts(*fins, np.zeros((6, 0)), pairs, np.eye(6), np.ones(6), False)


SHARING = Callee(
    steer_fins,
    lambda: (no_fins(), _SIX, _ROTATION, _THREE, _THREE, _THREE, np.zeros(0), 1.0, np.zeros(0), _SIX, _SIX),
    answers=np.float64,
)
"""What shares a wrench between fins and thrusters."""

ESTIMATING = Callee(
    estimate,
    lambda: (*nothing_sensed(), _THREE, _THREE, _ROTATION, _THREE, *_records(ESTIMATE, ERROR, READING)),
    answers=np.int64,
)
"""The navigation."""
