"""Which vehicles touch each other, said when it begins and ends."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from cube_sim.mission.fleet import FleetMission


class Touching:
    """Watches for contacts between vehicles.

    Args:
        mission: of the vehicles.
    """

    def __init__(self, mission: FleetMission) -> None:
        roots = {one.vehicle.body: index for index, one in enumerate(mission.missions.values())}
        model = mission.model
        self._names = tuple(mission.missions)
        self._of_geom = np.array([roots.get(int(model.body_rootid[b]), -1) for b in model.geom_bodyid], dtype=np.int64)
        self._pairs: set[tuple[int, int]] = set()

    def changes(self, data: mujoco.MjData) -> Iterator[str]:
        """A sentence for each two that begin to touch, and that touch no more."""
        if not data.ncon and not self._pairs:
            return
        now = {(a, b) for a, b in self._touching(data) if 0 <= a != b >= 0}
        for a, b in sorted(now - self._pairs):
            yield f"{self._names[a]} and {self._names[b]} touch"
        for a, b in sorted(self._pairs - now):
            yield f"{self._names[a]} and {self._names[b]} touch no more"
        self._pairs = now

    def _touching(self, data: mujoco.MjData) -> Iterator[tuple[int, int]]:
        for contact in range(data.ncon):
            geoms = data.contact[contact].geom
            if data.contact[contact].dist <= 0.0 and (geoms >= 0).all():
                a, b = sorted(self._of_geom[geoms].tolist())
                yield a, b
