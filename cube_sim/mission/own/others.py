"""What code of the user's own sees of the other vehicles in the same water."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import mujoco

from cube_sim.spatial import State
from cube_sim.vehicle.state import read_state
from cube_sim.vehicle.vehicle import Vehicle


class Others(Mapping[str, State]):
    """The true states of the other vehicles, by name, each as it was at the beginning of the tick.

    A state is read when it is asked for, as a copy. So whoever asks at a tick sees the same, in whatever order the
    vehicles are flown.

    Args:
        data: MuJoCo's, of all of them; None where nobody else is there.
        vehicles: the others in it, by name.
    """

    def __init__(self, data: mujoco.MjData | None = None, vehicles: Mapping[str, Vehicle] | None = None) -> None:
        self._data, self._vehicles = data, dict(vehicles or {})

    def __getitem__(self, name: str) -> State:
        """The state of one.

        Raises:
            KeyError: there is none of that name.
        """
        if name not in self._vehicles or self._data is None:
            raise KeyError(f"no other vehicle {name!r}; there are {', '.join(self._vehicles) or 'none'}")
        return read_state(self._vehicles[name], self._data)

    def __iter__(self) -> Iterator[str]:
        """Their names, in the order of the scenario."""
        return iter(self._vehicles)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._vehicles)

    def __eq__(self, other: object) -> bool:
        """Itself alone: what it shows changes."""
        return self is other

    def __hash__(self) -> int:
        """Of itself."""
        return id(self)

    def __deepcopy__(self, memo: Any) -> Others:
        """The same: it only looks."""
        return self


NOBODY = Others()
"""Seen by a vehicle that is alone."""
