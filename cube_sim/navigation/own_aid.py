"""A sensor whose law is plain Python: compiled code asks it through C, with its numbers in two flat arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cube_sim.native.compiled import call_in_c, compiled
from cube_sim.navigation.aid import MOST_COMPONENTS, OWN
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Matrix, Record, Vector, rotation_about

SEEN, TOLD = 18, MOST_COMPONENTS * 13
"""Numbers that go there (position, velocity, rotation, rates) and come back (reading, its rows of H_motion)."""
STEP = 1e-4
"""By which a motion is moved, either way, to see how a reading changes with it [m, m/s, rad, rad/s].

The error is of order STEP^2 by curvature and rounding / STEP: 1e-8 and 1e-11 of readings some metres large.
"""

_LAW = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double))


@dataclass(frozen=True)
class OwnAid:
    """z = h(motion) + b + noise, h being a function in Python.

    Attributes:
        name: one word.
        sampling: rate and delay.
        components: numbers in a reading.
        noise: standard deviation of each, in its unit.
        bias: standard deviation of each component's b, in its unit; 0 for none.
        angle: whether a reading is an angle [rad], whose differences go the short way round.
        reading: h, a function of a `Motion`: (n,), or None where there is nothing to read.
        jacobian: dh / d[dp, dv, phi, dw] (n,12), a function of a `Motion`: world position and velocity, rotation vector
            in world axes with R = Exp(phi) R_0, rates in body axes. None for differences of `reading`.
        failures: what h has raised, until somebody takes it away.
    """

    name: str
    sampling: Sampling
    components: int
    noise: float
    bias: float
    angle: bool
    reading: Callable[[Motion], Vector | None]
    jacobian: Callable[[Motion], Matrix] | None = None
    kind: int = field(default=OWN, init=False)
    site: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), init=False)
    failures: list[BaseException] = field(default_factory=list, init=False)

    @property
    def constants(self) -> Vector:
        """Standard deviations of b."""
        return np.full(self.components if self.bias > 0.0 else 0, self.bias)

    @cached_property
    def law(self) -> ctypes._CFunctionType:
        """h and its derivative as C calls them; kept, as the address of its code is."""
        return _LAW(self._answer)

    @cached_property
    def address(self) -> int:
        """Where the code of `law` lies, in this process."""
        return ctypes.cast(self.law, ctypes.c_void_p).value or 0

    def _answer(self, seen: ctypes._Pointer[ctypes.c_double], told: ctypes._Pointer[ctypes.c_double]) -> int:
        """Fill `told`; whether there is a reading."""
        try:
            numbers = np.ctypeslib.as_array(seen, (SEEN,)).copy()
            motion = Motion(numbers[:3], numbers[3:6], numbers[6:15].reshape(3, 3), numbers[15:])
            value = self.reading(motion)
            if value is None:
                return 0
            rows = self.differences(motion) if self.jacobian is None else self.jacobian(motion)
            if rows is None:
                return 0
            answer, n = np.ctypeslib.as_array(told, (TOLD,)), self.components
            answer[:n], answer[MOST_COMPONENTS : MOST_COMPONENTS + 12 * n] = value, rows.ravel()
            return 1
        except BaseException as error:  # nothing may go through C
            self.failures.append(error)
            return 0

    def differences(self, motion: Motion) -> Matrix | None:
        """`jacobian` by central differences; None where there is no reading beside the motion."""
        H = np.empty((self.components, 12))
        for j in range(12):
            ahead, behind = (self.reading(moved(motion, j, step)) for step in (STEP, -STEP))
            if ahead is None or behind is None:
                return None
            change = ahead - behind
            if self.angle:
                change = np.remainder(change + np.pi, 2.0 * np.pi) - np.pi
            H[:, j] = change / (2.0 * STEP)
        return H


def moved(motion: Motion, which: int, step: float) -> Motion:
    """A motion with one of [dp, dv, phi, dw] moved.

    Args:
        motion: the motion.
        which: 0 to 11.
        step: by how much [m, m/s, rad, rad/s].
    """
    part, axis = divmod(which, 3)
    shift = np.zeros(3)
    shift[axis] = step
    if part == 2:
        return motion._replace(rotation=rotation_about(np.eye(3)[axis], step) @ motion.rotation)
    name = ("position", "velocity", "rotation", "rates")[part]
    return motion._replace(**{name: getattr(motion, name) + shift})


def tell_laws(records: Record, aids: Sequence[object]) -> None:
    """Write into the records of sensors (k,) where the laws of one's own among them lie in this process."""
    for record, aid in zip(records, aids, strict=True):
        if isinstance(aid, OwnAid):
            record["law"], record["angle"] = aid.address, aid.angle


@compiled
def own_reading(aid, constants, position, velocity, R, rates, value, H_motion, H_constants):
    """As `cube_sim.navigation.expectation.expect`."""
    seen, told, n = np.empty(18), np.empty(39), aid.components
    for i in range(3):
        seen[i], seen[3 + i], seen[15 + i] = position[i], velocity[i], rates[i]
        for j in range(3):
            seen[6 + 3 * i + j] = R[i, j]
    if aid.law == 0 or call_in_c(aid.law, seen, told) == 0:
        return False
    for i in range(n):
        value[i] = told[i]
        for j in range(12):
            # true rates are smaller by the bias that the last three are the error of
            H_motion[i, j] = told[3 + 12 * i + j] if j < 9 else -told[3 + 12 * i + j]
        if aid.constants > 0:
            value[i] += constants[i]
            H_constants[i, i] = 1.0
    return True
