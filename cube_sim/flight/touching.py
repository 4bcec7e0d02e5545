"""Which vehicles touch each other, said when it begins and ends."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from cube_sim.mission.fleet import FleetMission

APART_S = 1.0
"""Two that touch again within this time touch still: hulls bounce [s]."""


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
        self._last_s: dict[tuple[int, int], float] = {}

    def changes(self, t: float, data: mujoco.MjData) -> Iterator[str]:
        """A sentence for each two that begin to touch, and that have been apart for long enough.

        Args:
            t: simulated time [s].
            data: MuJoCo's, up to date.
        """
        if not data.ncon and not self._last_s:
            return
        now = {(a, b) for a, b in self._touching(data) if 0 <= a != b >= 0}
        for pair in sorted(now):
            if pair not in self._last_s:
                yield f"{' and '.join(self._names[each] for each in pair)} touch"
            self._last_s[pair] = t
        for pair in sorted(pair for pair, last in self._last_s.items() if t - last >= APART_S):
            last = self._last_s.pop(pair)
            yield f"{' and '.join(self._names[each] for each in pair)} have touched until {last:.2f} s"

    def _touching(self, data: mujoco.MjData) -> Iterator[tuple[int, int]]:
        for contact in range(data.ncon):
            geoms = data.contact[contact].geom
            if data.contact[contact].dist <= 0.0 and (geoms >= 0).all():
                a, b = sorted(self._of_geom[geoms].tolist())
                yield a, b
