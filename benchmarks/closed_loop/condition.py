"""What the controller knows wrongly while a loop is looked at."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

WRONG = 0.3
"""Share by which drag, added mass and thrust are believed wrong."""
CURRENT_M_S = 0.5
"""Error of a current estimate."""


class Condition(NamedTuple):
    """Factors on what is believed, and a current that is estimated wrongly.

    Attributes:
        drag: believed drag as a share of the true one.
        added_mass: the same of the added mass.
        thrust: the same of the force of every thruster.
        water: velocity of the water (3,) [m/s], in axes of the path: ahead, left, up.
        believed: what the estimate of it is frozen at (3,) [m/s]; None while it is estimated on.
    """

    drag: float = 1.0
    added_mass: float = 1.0
    thrust: float = 1.0
    water: tuple[float, float, float] = (0.0, 0.0, 0.0)
    believed: tuple[float, float, float] | None = None

    @property
    def words(self) -> str:
        """What is wrong, in a few words."""
        factors = {"drag": self.drag, "added mass": self.added_mass, "thrust": self.thrust}
        said = [f"{name} x{factor:g}" for name, factor in factors.items() if factor != 1.0]
        for name, current in (("water", self.water), ("believed", self.believed)):
            if current is not None and any(current):
                said.append(f"{name} {'/'.join(f'{v:g}' for v in current)} m/s")
        return ", ".join(said) or "the truth"


NOMINAL = Condition()


def one_at_a_time() -> list[Condition]:
    """Each factor wrong by itself; and each direction of a current: there and not believed, believed and not there."""
    factors = (1.0 - WRONG, 1.0 + WRONG)
    wrong = [Condition(**{name: factor}) for name in ("drag", "added_mass", "thrust") for factor in factors]
    none = (0.0, 0.0, 0.0)
    for axis, sign in product(range(3), (-1.0, 1.0)):
        current = (*none[:axis], sign * CURRENT_M_S, *none[axis + 1 :])
        wrong += [Condition(water=current, believed=none), Condition(believed=current)]
    return wrong


def corners() -> list[Condition]:
    """All factors wrong at once, with the current estimated on, or frozen wrong ahead, astern or aside."""
    factors = (1.0 - WRONG, 1.0 + WRONG)
    estimates = [None, (CURRENT_M_S, 0.0, 0.0), (-CURRENT_M_S, 0.0, 0.0), (0.0, CURRENT_M_S, 0.0)]
    return [
        Condition(drag, added_mass, thrust, believed=believed)
        for drag, added_mass, thrust, believed in product(factors, factors, factors, estimates)
    ]
