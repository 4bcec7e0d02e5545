"""What several vehicles record, on its way into one record."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cube_sim.flight.vehicle_loop import VehicleStore
from cube_sim.recording.batch import Rows
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine
from cube_sim.scenario.distance_block import DISTANCE
from cube_sim.scenario.fleet import FleetScenario, of_vehicle

_POSITION = slice(1, 4)
"""Columns of the channel `pose`."""


class FleetStore:
    """Hands rows and sentences of each vehicle on under its name, in the order of time.

    Args:
        store: the record of all.
        vehicles: where those of each vehicle arrive.
        scenario: of all.
    """

    def __init__(self, store: SignalStore, vehicles: Mapping[str, VehicleStore], scenario: FleetScenario) -> None:
        self._store, self._vehicles, self._pairs = store, vehicles, scenario.pairs
        self._said: list[LogLine] = []

    def log(self, t: float, level: str, text: str) -> None:
        """Record a sentence on all of them."""
        self._said.append(LogLine(round(t, 9), level, text))

    def ticks_at_once(self, tick: int, period: float) -> int:
        """Of how many ticks rows may be handed over at once, see `SignalStore.ticks_at_once`."""
        return self._store.ticks_at_once(tick, period)

    def hand_on(self) -> None:
        """Let the record have what has arrived: of one simulated second where files wait for it."""
        lines, self._said = self._said, []
        tables: dict[str, list[Rows]] = {}
        for name, vehicle in self._vehicles.items():
            for batch in vehicle.take():
                lines += [LogLine(line.t, line.level, f"{name}: {line.text}") for line in batch.log]
                for channel, rows in batch.rows.items():
                    tables.setdefault(of_vehicle(name, channel), []).append(rows)
        for line in sorted(lines, key=lambda line: line.t):
            self._store.log(line.t, line.level, line.text)
        whole = {channel: np.concatenate(parts) if len(parts) > 1 else parts[0] for channel, parts in tables.items()}
        if distances := self._distances(whole):
            whole[DISTANCE] = np.column_stack(distances)
        if whole:
            first = min(float(rows[0, 0]) for rows in whole.values())
            last = max(float(rows[-1, 0]) for rows in whole.values())
            self._store.extend(first, last, whole.items(), ours=True)

    def _distances(self, tables: Mapping[str, Rows]) -> list[Rows]:
        """Times, and the distance between each two vehicles, where all have rows."""
        found: list[Rows] = []
        for a, b in self._pairs:
            one, other = (tables.get(of_vehicle(name, "pose")) for name in (a, b))
            if one is None or other is None:
                return []
            n = min(len(one), len(other))  # a flight that ends amid a tick has rows of some vehicles
            found = found or [one[:, 0]]
            n = min(n, *(len(column) for column in found))
            distance = np.linalg.norm(one[:n, _POSITION] - other[:n, _POSITION], axis=1)
            found = [*(column[:n] for column in found), distance]
        return found
