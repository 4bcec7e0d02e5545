"""What the thrusters of a hull are fed with, and what they draw."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.spatial import Record
from cube_sim.vehicle import faults
from cube_sim.vehicle.battery import Battery
from cube_sim.vehicle.current import water_velocity
from cube_sim.vehicle.laws.curve_table import drawn_power
from cube_sim.vehicle.laws.propeller_power import DrivenPropellers, feel_flow, put_propellers_power
from cube_sim.vehicle.laws.supply_law import SUPPLY, charge_left, count, feed_at, sag
from cube_sim.vehicle.laws.voltage_law import VoltageTables, feed_tables, searched_voltage
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.state import hull_state
from cube_sim.vehicle.thrusters import Thrusters


class PowerSupply:
    """The bus of one hull: a battery that sags or, without one, the voltage of the characteristics.

    The voltage stays between two calls of `update`. A call gives voltage, forces and power that satisfy together

        F = F_n (V / V_n)^2,  P = k_P |F|^1.5,  V = E - R P / V.

    F_n are the forces at V_n, the voltage of the characteristics; E and R are the battery's
    (`cube_sim.vehicle.battery`). Of thrusters whose curves are known at several voltages, F and k_P are those at V. Of
    propellers whose drive or motor is known, P follows from the torque at V (`cube_sim.vehicle.laws.propeller_power`).

    Attributes:
        voltage: V [V]; V_n without a battery, 0 where the model does not say it, and 0 from an empty battery.
        force_ratio: (V / V_n)^2, the share of the characteristics' forces that the thrusters give.
        power: (m,) electrical power of each thruster [W].
        energy: drawn by the thrusters since the first update [J].
        record: all of it but the power, of `cube_sim.vehicle.laws.supply_law.SUPPLY`.
        supply_at: (m,) where in the model's own numbers the shares of force are.
        charge: of the battery, 1 full, 0 empty; 1 without one.
        tables: what of the thrusters follows the voltage, where their curves are known at several.
        by_tables: whether one does.
        driven: what propellers draw by their torques.
        searched: whether the voltage under load has to be searched for, since power does not go with its cube.
    """

    def __init__(
        self, model: mujoco.MjModel, thrusters: Thrusters, battery: Battery | None = None, charge: float = 1.0
    ) -> None:
        """Connect the thrusters.

        Args:
            model: made by `load_model`. With a battery, the supply of these thrusters in it changes: now to the
                battery's voltage without load, and at every update.
            thrusters: of one hull.
            battery: None for a constant voltage.
            charge: of the battery at the start, 0 < charge <= 1.

        Raises:
            ModelError: a battery for thrusters that do not say the voltage or the power of their characteristic, or
                that say different voltages.
        """
        self._model, self._thrusters = model, thrusters
        nominal = np.unique(thrusters.voltage)
        self._hull = _hull_of(model, thrusters)
        self._nominal = float(nominal[0]) if nominal.size == 1 and np.isfinite(nominal[0]) else 0.0
        if battery is not None:
            _require_known(thrusters, self._nominal)
        starts = np.array([faults.curve_start(model, name) for name in thrusters.in_model], dtype=np.int64)
        self._efficiency_at, self._stuck_at = starts + layout.EFFICIENCY, starts + layout.STUCK
        self.supply_at = starts + layout.SUPPLY
        record_at = packing.packed_parameters(model)[starts + layout.TABLES].astype(np.int64)
        known = (record_at >= 0) & (battery is not None)
        curves, begins = thrusters.curve_table
        self.by_tables = bool(known.any())
        self.tables = VoltageTables(
            known,
            record_at,
            starts,
            layout.CURVE,
            layout.POWER,
            curves.copy(),
            begins,
            thrusters.power_coefficients.copy(),
            thrusters.limits,
        )
        self.driven = _driven(model, thrusters)
        self.searched = battery is not None and (self.by_tables or bool(self.driven.draws.any()))
        self.power: NDArray[np.float64] = np.zeros(len(thrusters.names))
        self.record: Record = np.zeros(1, SUPPLY)
        r = self.record
        r["nominal"] = r["voltage"] = self._nominal
        r["force_ratio"], r["charge"], r["counted_to"] = 1.0, 1.0, np.nan
        if battery is not None:
            r["battery"], r["full"], r["lowest"] = True, battery.open_voltage, battery.lowest_voltage
            r["resistance"], r["capacity"], r["charge"] = battery.resistance, battery.capacity, charge
            self._feed_at(battery.open_voltage_at(charge))

    def update(self, data: mujoco.MjData) -> bool:
        """Feed the thrusters according to what they draw now, and count it.

        Args:
            data: of the model, up to date (mj_forward). With a battery it is up to date again at the new voltage.

        Returns:
            Whether the battery has just run empty.
        """
        emptied = False
        if self.sags:
            self.record["charge"] = charge_left(self.record, data.time)
            emptied = self.charge == 0.0 and self.force_ratio > 0.0
            if emptied:
                self._feed_at(0.0)
            elif self.force_ratio > 0.0:
                self._sag(data)
            if emptied or self.force_ratio > 0.0:
                mujoco.mj_forward(self._model, data)
        power = self._power(data)
        count(self.record, self.power, power, data.time)
        self.power = power
        return emptied

    @property
    def voltage(self) -> float:
        """V [V]."""
        return float(self.record["voltage"][0])

    @property
    def force_ratio(self) -> float:
        """(V / V_n)^2."""
        return float(self.record["force_ratio"][0])

    @property
    def charge(self) -> float:
        """Of the battery."""
        return float(self.record["charge"][0])

    @property
    def energy(self) -> float:
        """Drawn so far [J]."""
        return float(self.record["energy"][0])

    @property
    def sags(self) -> bool:
        """Whether its voltage depends on what is drawn."""
        return bool(self.record["battery"][0])

    @property
    def drawing(self) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """The arguments of `drawn_power` before the forces, of thrusters whose torques do not say what they draw."""
        packed = packing.packed_parameters(self._model)
        return packed, self._efficiency_at, self._stuck_at, self.tables.coefficients

    def _power(self, data: mujoco.MjData) -> NDArray[np.float64]:
        """(m,) electrical power [W] of thrusters whose propellers may be damaged.

        What a damaged propeller loses, its motor draws all the same. A dead motor draws nothing.
        """
        power = drawn_power(*self.drawing, data.actuator_force[self._thrusters.actuators])
        if self.driven.draws.any():
            state = hull_state(data.qpos, data.qvel, data.xmat, data.xquat, *self._hull)
            feel_flow(self.driven, state, water_velocity(self._model, data.time, float(state[2])))
            packed, efficiency_at, stuck_at, _ = self.drawing
            told = packed, efficiency_at, stuck_at, self.supply_at
            put_propellers_power(self.driven, data.act, *told, power)
        return power

    def _sag(self, data: mujoco.MjData) -> None:
        """Feed the thrusters with the voltage at which battery and propellers agree."""
        packed, efficiency_at, stuck_at, _ = self.drawing
        drawn = self._power(data)
        if self.searched:
            given = packed, efficiency_at, stuck_at, data.act, drawn
            self._feed_at(searched_voltage(self.record, self.tables, self.driven, *given))
        else:
            sag(self.record, packed, self.supply_at, drawn)

    def _feed_at(self, voltage: float) -> None:
        packed = self.drawing[0]
        feed_at(self.record, packed, self.supply_at, voltage)
        if self.by_tables:
            feed_tables(self.tables, packed, self.supply_at, voltage)


def _hull_of(model: mujoco.MjModel, thrusters: Thrusters) -> tuple[int, int, int]:
    """Where the pose of their hull begins, where its velocity does, and the index of its body."""
    site = int(model.actuator_trnid[thrusters.actuators[0], 0]) if len(thrusters.names) else 0
    body = int(model.body_rootid[model.site_bodyid[site]]) if model.nsite else 0
    joint = int(model.body_jntadr[body])
    return int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint]), body


def _driven(model: mujoco.MjModel, thrusters: Thrusters) -> DrivenPropellers:
    of, m = thrusters.propellers, len(thrusters.names)
    return DrivenPropellers(
        thrusters.draws_by_torque,
        of.rows.copy(),
        of.points.copy(),
        thrusters.activations.astype(np.int64),
        model.actuator_actadr[thrusters.actuators].astype(np.int64),
        model.site_size[model.actuator_trnid[thrusters.actuators, 0], 0].astype(np.float64),
        float(packing.packed_parameters(model)[layout.SURFACE]),
        np.zeros(m),
        np.ones(m),
    )


def has_voltage_tables(model: mujoco.MjModel, thrusters: Thrusters) -> bool:
    """Whether a curve of one of them is known at several voltages."""
    packed = packing.packed_parameters(model)
    return any(packed[faults.curve_start(model, name) + layout.TABLES] >= 0.0 for name in thrusters.in_model)


def _require_known(thrusters: Thrusters, nominal: float) -> None:
    known, turns = thrusters.power_known, thrusters.propellers.turns
    for name, voltage, power, propeller in zip(thrusters.names, thrusters.voltage, known, turns, strict=True):
        if np.isnan(voltage):
            raise ModelError(f"{name}:thruster_voltage", "is not in the model, so a battery cannot feed this thruster")
        if not power:
            parameter = "propeller_efficiency" if propeller else "thruster_power"
            raise ModelError(f"{name}:{parameter}", "is not known, so nobody can tell what it draws from a battery")
    if nominal == 0.0:
        listed = ", ".join(f"{name} {v:g} V" for name, v in zip(thrusters.names, thrusters.voltage, strict=True))
        raise ModelError("thruster_voltage", f"differs among the thrusters of one battery: {listed}")
