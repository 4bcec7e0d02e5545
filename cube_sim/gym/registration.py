"""The ids under which `gymnasium.make` knows the scenarios that come with the package."""

from __future__ import annotations

from typing import Any

import gymnasium

from cube_sim.shipped import shipped_root

_HOLD = {
    "name": "cube_hold",
    "description": "The CUBE keeps a place and a heading in a current.",
    "duration_s": 20.0,
    "current_m_s": [0.15, -0.1, 0.0],
    "initial": {"position_m": [0.5, -0.5, -5.5], "attitude_deg": [0.0, 0.0, 40.0]},
    "path": {"type": "point", "position_m": [0.0, 0.0, -5.0]},
    "guidance": {"speed_m_s": 0.4},
    "checks": [{"kind": "allowed_forces"}],
}

IDS: dict[str, tuple[str, dict[str, Any]]] = {
    "cube_sim/CubeHelix-v0": ("cube_helix", {}),
    "cube_sim/CubeHold-v0": ("cube_helix", _HOLD),
    "cube_sim/BlueROV2Free-v0": ("bluerov2_free", {}),
    "cube_sim/BlueROV2VectoredHelix-v0": ("bluerov2_vectored_helix", {}),
    "cube_sim/InfanteLine-v0": ("infante_line", {}),
    "cube_sim/Rov6Helix-v0": ("rov6_helix", {}),
    "cube_sim/TorpedoLine-v0": ("torpedo_line", {}),
}
"""Id -> a scenario that comes with the package, and what replaces values of it."""


def register_all() -> None:
    """Tell Gymnasium of the ids; those it knows already are left as they are."""
    folder = shipped_root() / "scenarios"
    for name, (scenario, overrides) in IDS.items():
        if name not in gymnasium.registry:
            arguments = {"scenario": str(folder / f"{scenario}.yaml"), "overrides": overrides}
            gymnasium.register(name, "cube_sim.gym.flight_env:FlightEnv", kwargs=arguments)
