"""The battery of a scenario."""

from __future__ import annotations

from pydantic import Field, field_validator

from cube_sim.scenario.values import Block, Volts2, refuse

LEAST_V = 0.01


class BatteryBlock(Block):
    """What feeds the thrusters: their force falls with its voltage, and its voltage with what they draw."""

    open_circuit_V: Volts2 = Field(  # noqa: N815 - V is the volt
        description="Voltage without load, [empty, full] [V]; it falls in a straight line with the charge."
    )
    resistance_ohm: float = Field(ge=0, le=1e6, description="Resistance of cells and cable [ohm].")
    capacity_Wh: float = Field(  # noqa: N815 - Wh is the watt hour
        ge=1e-6, le=1e12, description="Energy from full to empty at open circuit [Wh]."
    )
    charge: float = Field(default=1.0, ge=1e-6, le=1, description="Share of the capacity left at the start.")

    @field_validator("open_circuit_V")
    @classmethod
    def _positive_and_in_order(cls, open_circuit_V: Volts2) -> Volts2:
        if not LEAST_V <= open_circuit_V[0] <= open_circuit_V[1]:
            refuse(f"must be [empty, full] with {LEAST_V:g} <= empty <= full, got {list(open_circuit_V)}")
        return open_circuit_V
