"""What many flights of one scenario have in common, made once."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

Thing = TypeVar("Thing")

MOST = 16
"""So many things are kept for each vehicle: what each flight has for itself would fill the memory."""


class Shared:
    """Keeps what was made for one flight for those that come after; several threads may ask at once.

    Whoever asks holds that nothing which the thing is made of changes meanwhile, as a file on disk, and that nobody
    changes the thing.

    Args:
        vehicles: how many fly in each flight.
    """

    def __init__(self, vehicles: int = 1) -> None:
        self._things: OrderedDict[Hashable, Any] = OrderedDict()
        self._vehicles = vehicles
        self._lock = threading.Lock()

    def get(self, key: Hashable, make: Callable[[], Thing]) -> Thing:
        """The thing of a key, made where there is none yet.

        Args:
            key: all that the thing is made of.
            make: makes it; where two make it at once, one of the two is kept.
        """
        with self._lock:
            if key in self._things:
                self._things.move_to_end(key)
                return self._things[key]
        made = make()
        with self._lock:
            kept = self._things.setdefault(key, made)
            while len(self._things) > MOST * self._vehicles:
                self._things.popitem(last=False)
        return kept

    def __reduce__(self) -> tuple[type[Shared], tuple[int]]:
        """In another process it is made anew."""
        return Shared, (self._vehicles,)
