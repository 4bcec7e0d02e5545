"""The state of a whole flight as bytes: physics, and all that controller, estimators and allocation remember."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Snapshot:
    """A moment of a flight. It can be pickled, and taken up by any flight of the same scenario, to the bit.

    Attributes:
        digest: of the scenario it belongs to, and of the code it names.
        content: what changes in a flight.
    """

    digest: str
    content: bytes
