"""What happens to the vehicle and the water during a run."""

from __future__ import annotations

from math import ceil, nan, radians
from sys import maxsize
from typing import NamedTuple, assert_never

import mujoco

from cube_sim.mission.sensor_faults import SensorEvents
from cube_sim.mission.water import water_schedule
from cube_sim.navigation.faults import SensorFaults
from cube_sim.scenario import Scenario
from cube_sim.scenario.event_blocks import (
    AnyEvent,
    CurrentEventBlock,
    ForceEventBlock,
    SetpointEventBlock,
    ThrusterEventBlock,
)
from cube_sim.scenario.fin_event_block import FinEventBlock
from cube_sim.scenario.sensor_event_block import SensorEventBlock
from cube_sim.vehicle import faults, fin_faults
from cube_sim.vehicle.current import set_current
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.health import Health

SAME_S = 1e-9
"""Times that differ by less are the same: those of ticks are rounded [s]."""


class Due(NamedTuple):
    """What is to happen.

    Attributes:
        at_s: when [s].
        over: whether it is the end of the event, else its beginning.
        event: the event.
    """

    at_s: float
    over: bool
    event: AnyEvent


class Events:
    """The events of a run, each carried out once when its time has come.

    Args:
        scenario: that has them.
        model: that flies; changed here.
        vehicle: whose thrusters fail.
        faults: of its sensors, changed here; None without sensors.

    Attributes:
        health: the true state of the thrusters.
        fin_health: that of the fins.
        fins_told: what the controller has been told of these.
    """

    def __init__(
        self, scenario: Scenario, model: mujoco.MjModel, vehicle: Vehicle, faults: SensorFaults | None = None
    ) -> None:
        begins = [Due(event.at_s, False, event) for event in scenario.events]
        ends = [Due(event.ends[0], True, event) for event in scenario.events if event.ends is not None]
        # What ends at a time does so before what begins then.
        self._pending = sorted([*begins, *ends], key=lambda due: (due.at_s, not due.over))
        self._sensors = SensorEvents(faults, scenario.control_period_s)
        self._model, self._vehicle = model, vehicle
        water = water_schedule(scenario)
        self._tables = None if water is None else list(water.tables[1:])
        self.health = Health.whole(len(vehicle.thrusters.names))
        self.fin_health = FinHealth.whole(0 if vehicle.fins is None else len(vehicle.fins.names))
        self.fins_told = self.fin_health

    def apply_due(self, t: float) -> list[tuple[str, str]]:
        """Apply the events due at t [s]; returns level and text of a line each, for the log."""
        lines: list[tuple[str, str]] = []
        while self._pending and self._pending[0].at_s <= t + SAME_S:
            _, over, event = self._pending.pop(0)
            if not over:
                planned = isinstance(event, SetpointEventBlock)
                lines.append(("INFO" if planned else "WARNING", self._apply(event)))
            elif event.ends is not None:
                if isinstance(event, SensorEventBlock):
                    self._sensors.end(event)
                lines.append(("INFO", event.ends[1]))
        return lines

    def ticks_before(self, tick: int, period: float) -> int:
        """How many ticks, from this one on, come before the next event; very many when there is none.

        Args:
            tick: its number.
            period: of the ticks [s].
        """
        if not self._pending:
            return maxsize
        at = self._pending[0].at_s
        due = max(tick, ceil(at / period) + 1)
        while due > tick and at <= (due - 1) * period + SAME_S:
            due -= 1
        return due - tick

    def _apply(self, event: AnyEvent) -> str:
        match event:
            case CurrentEventBlock():
                self._change_current(event)
                return event.message
            case ForceEventBlock():  # it is in the model from the start
                return event.message
            case SetpointEventBlock():  # it is in the table from the start
                return event.message
            case SensorEventBlock():
                self._sensors.begin(event)
                return event.message
            case ThrusterEventBlock():
                for name in event.thrusters:
                    self._change(name, event)
                return event.message
            case FinEventBlock():
                for name in event.fins:
                    self._change_fin(name, event)
                return event.message
            case _:
                assert_never(event)

    def _change_current(self, event: CurrentEventBlock) -> None:
        if self._tables is None:
            self._model.opt.wind[:] = event.current_m_s
        elif not event.over_s:  # what changes within a time is in the table from the start
            set_current(self._model, self._tables.pop(0))

    def _change_fin(self, name: str, event: FinEventBlock) -> None:
        fins = self._vehicle.fins
        assert fins is not None
        index = fins.names.index(name)
        model, in_model, health = self._model, self._model.actuator(int(fins.actuators[index])).name, self.fin_health
        if event.state == "jammed":
            angle = None if event.angle_deg is None else radians(event.angle_deg)
            fin_faults.jam_fin(model, in_model, angle)
            self.fin_health = health.with_fin(index, jammed=True, angle=nan if angle is None else angle)
        elif event.state == "loose":
            fin_faults.loosen_fin(model, in_model)
            self.fin_health = health.with_fin(index, loose=True)
        elif event.rate_deg_s is not None:
            fin_faults.slow_fin(model, in_model, radians(event.rate_deg_s))
            self.fin_health = health.with_fin(index, rate=radians(event.rate_deg_s))
        elif event.travel_deg is not None:
            low, high = map(radians, event.travel_deg)
            fin_faults.shorten_travel(model, in_model, low, high)
            self.fin_health = health.with_fin(index, travel=(low, high))
        else:
            fin_faults.repair_fin(model, in_model)
            self.fin_health = health.with_fin(index)

    def _change(self, name: str, event: ThrusterEventBlock) -> None:
        index = self._vehicle.thrusters.names.index(name)
        in_model = self._vehicle.thrusters.in_model[index]
        if event.force_N is not None:
            faults.set_stuck(self._model, in_model, event.force_N)
            self.health = self.health.with_thruster(index, 0.0, event.force_N)
            return
        efficiency = {"dead": 0.0, "weak": event.efficiency, "recovered": 1.0}[event.state] or 0.0
        faults.set_efficiency(self._model, in_model, efficiency)
        self.health = self.health.with_thruster(index, efficiency)
