"""A battery for a drafted vehicle, of which its voltages alone are known."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cube_sim.vehicle.thrusters import Thrusters

_FULL_POWER_MIN = 8.0
"""Minutes for which it feeds all thrusters at their largest forces: an hour of a mission that takes some 13 % of that,
as small vehicles have (a choice)."""
_SAG = 0.1
"""Share of its mean voltage that it loses at half of that power (a choice)."""


def drafted_battery(thrusters: Thrusters, empty_V: float, full_V: float) -> dict[str, str] | None:
    """Keys of a `battery` block and their values, in YAML; None where the power of no thruster is known.

    Args:
        thrusters: of the vehicle.
        empty_V: its voltage without load, empty [V].
        full_V: likewise, full [V].
    """
    power = float(thrusters.power(thrusters.limits[:, [0, 3]].T).max(axis=0, initial=0.0).sum())
    if power <= 0.0:
        return None
    mean = 0.5 * (empty_V + full_V)
    resistance, capacity = _SAG * mean * mean / (0.5 * power), power * _FULL_POWER_MIN / 60.0
    return {
        "open_circuit_V": f"[{empty_V:g}, {full_V:g}]   # empty, full",
        "resistance_ohm": f"{resistance:.2g}   # a choice: measure by how much it sags under load",
        "capacity_Wh": f"{capacity:.3g}   # a choice: what its label says",
    }
