"""What every aiding sensor says of itself, and the record of it that the compiled laws read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from cube_sim.navigation.gate import GATES
from cube_sim.navigation.sampling import Sampling
from cube_sim.navigation.strapdown import CONSTANTS
from cube_sim.spatial import Record, Vector

DVL, DEPTH, HEADING, POSITION, OWN = range(5)
"""Kinds of sensors; `cube_sim.navigation.expectation` says what each reads."""
MOST_COMPONENTS, MOST_CONSTANTS = 3, 4
"""Numbers in a reading, and constant errors of a sensor, at most: what the compiled laws have room for."""

AID = np.dtype(
    [
        ("kind", np.int64),
        ("components", np.int64),
        ("constants", np.int64),
        ("place", np.int64),
        ("delay", np.int64),
        ("rate_hz", np.float64),
        ("noise", np.float64),
        ("gate", np.float64),
        ("site", np.float64, 3),
        ("law", np.int64),
        ("angle", np.bool_),
    ]
)
"""One sensor, the same type for all kinds.

Its kind; the numbers n in a reading and c of its constant errors; where those begin in the filter's error; the ticks a
reading is under way; its rate [Hz]; the standard deviation of its noise; the NIS beyond which a reading is rejected;
its site [m]; of a law of one's own the address, and whether it reads an angle. See `Aid`.
"""


class Aid(Protocol):
    """A sensor beside the inertial unit. Its error is a few constants, drawn once per run, and white noise."""

    @property
    def kind(self) -> int:
        """By which its law is found."""
        ...

    @property
    def name(self) -> str:
        """One word; also names its random stream and its channel."""
        ...

    @property
    def sampling(self) -> Sampling:
        """When it takes readings, and how late they arrive."""
        ...

    @property
    def components(self) -> int:
        """Numbers n in a reading, `MOST_COMPONENTS` at most."""
        ...

    @property
    def noise(self) -> float:
        """Standard deviation of each component of a reading, in its unit."""
        ...

    @property
    def constants(self) -> Vector:
        """Standard deviations (c,) of its constant errors, `MOST_CONSTANTS` at most."""
        ...

    @property
    def site(self) -> tuple[float, float, float]:
        """The place its law needs [m]: where it sits, or where what it looks at is; zeros where it needs none."""
        ...


def aid_records(aids: Sequence[Aid], period_s: float) -> Record:
    """The sensors as compiled laws read them: (k,) of `AID`, their constants one after the other in the error.

    Args:
        aids: the sensors.
        period_s: length of a tick.

    Raises:
        ValueError: a reading of more numbers, or more constant errors, than the laws have room for.
    """
    records, place = np.zeros(len(aids), AID), CONSTANTS
    for record, aid in zip(records, aids, strict=True):
        c = len(aid.constants)
        if not 1 <= aid.components <= MOST_COMPONENTS or c > MOST_CONSTANTS:
            raise ValueError(
                f"{aid.name}: {aid.components} numbers in a reading and {c} constant errors; the laws have room for"
                f" {MOST_COMPONENTS} and {MOST_CONSTANTS}"
            )
        record["kind"], record["components"], record["constants"], record["place"] = aid.kind, aid.components, c, place
        record["delay"], record["rate_hz"] = aid.sampling.delay_ticks(period_s), aid.sampling.rate_hz
        record["noise"], record["gate"], record["site"] = aid.noise, GATES[aid.components], aid.site
        place += c
    return records
