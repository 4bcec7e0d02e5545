"""The state of a whole flight as bytes: physics, and all that controller, estimators and allocation remember."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Snapshot:
    """A moment of a flight. It can be pickled, and taken up by any flight of the same scenario, to the bit.

    Attributes:
        digests: of what it belongs to, SHA-256 by name: of the scenario, of every file that flies in it, of its path.
        content: what changes in a flight.
    """

    digests: Mapping[str, str]
    content: bytes
