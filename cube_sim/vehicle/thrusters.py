"""The thrusters of one vehicle, seen together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.laws.propeller import COLUMNS, DRIVE, MOTOR
from cube_sim.vehicle.mjcf.thruster_elements import thruster_actuators
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.pulse import PulseRange


class PropellerTable(NamedTuple):
    """Which of m thrusters are propellers in their inflow, and their numbers.

    Attributes:
        turns: (m,) whether each is one.
        rows: (m, `COLUMNS`) as `cube_sim.vehicle.laws.propeller` has them; zero for others.
        points: (k,) their open-water points.
    """

    turns: NDArray[np.bool_]
    rows: NDArray[np.float64]
    points: NDArray[np.float64]


@dataclass(frozen=True)
class Thrusters:
    """The m thrusters of a hull, in the order of the columns of its actuation matrix and of the model's actuators.

    Attributes:
        names: (m,) actuator names, without the prefix.
        actuators: (m,) indices into ctrl and actuator_force.
        activations: (m,) indices into act, of the lagged commands whose force the characteristics give. They follow
            from the commands alone, as MuJoCo integrates them (delay, lag, steps of its integrator): whatever fails in
            a thruster, fails behind them.
        characteristics: (m,) steady command-to-force curves; of propellers, in water that does not flow.
        lag_s: (m,) time constants of the motors [s]; of two lags in a row, their sum.
        power_coefficients: (m,2) k_P-, k_P+ of the electrical power k_P |F|^1.5 [W/N^1.5]; 0 where not known.
        voltage: (m,) the voltage at which each characteristic holds [V]; NaN where not known.
        pulse_ranges: (m,) what stands for the commands on the wire; None where not known.
        propellers: which of them are propellers in their inflow.
        prefix: of their names in the model, where that is joined of several.
    """

    names: tuple[str, ...]
    actuators: NDArray[np.int_]
    activations: NDArray[np.int_]
    characteristics: tuple[Characteristic, ...]
    lag_s: NDArray[np.float64]
    power_coefficients: NDArray[np.float64]
    voltage: NDArray[np.float64]
    pulse_ranges: tuple[PulseRange | None, ...]
    propellers: PropellerTable
    prefix: str = ""

    @staticmethod
    def from_model(model: mujoco.MjModel, body: int) -> Thrusters:
        """Read the thrusters that push one hull, in the order of the model's actuators.

        Args:
            model: made by `load_model`.
            body: index of the hull.

        Raises:
            ModelError: the model has no water.
        """
        packed = packing.packed_parameters(model)
        actuators = thruster_actuators(model, body)
        curves = [packed[_curve_start(packed, i) :] for i in actuators]
        return Thrusters(
            names=tuple(model.actuator(i).name for i in actuators),
            actuators=np.array(actuators, dtype=int),
            activations=np.array(
                [model.actuator_actadr[i] + model.actuator_actnum[i] - 1 for i in actuators], dtype=int
            ),
            characteristics=tuple(_characteristic(curve) for curve in curves),
            power_coefficients=np.array([curve[layout.POWER :][:2] for curve in curves]).reshape(-1, 2),
            lag_s=np.array([_lag_s(model, i) for i in actuators]),
            voltage=np.array([curve[layout.VOLTAGE] for curve in curves]),
            pulse_ranges=tuple(_pulse_range(curve) for curve in curves),
            propellers=_propellers(packed, [int(curve[layout.PROPELLER]) for curve in curves]),
        )

    @property
    def in_model(self) -> tuple[str, ...]:
        """(m,) their names in the model."""
        return tuple(f"{self.prefix}{name}" for name in self.names)

    @property
    def limits(self) -> NDArray[np.float64]:
        """(m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N] per thruster."""
        return np.array([curve.limits for curve in self.characteristics]).reshape(-1, 4)

    def limits_at(self, velocity: ArrayLike) -> NDArray[np.float64]:
        """(m,4) limits [N] of a hull that moves through the water: those of propellers follow their inflow.

        Args:
            velocity: [v; w] (6,) through the water [m/s, rad/s], body axes.
        """
        limits, of = self.limits, self.propellers
        if not of.turns.any():
            return limits
        from cube_sim.vehicle.laws.propeller import held_forces, speed_of_advance  # only here: it loads the compiler

        nu_r = tuple(np.asarray(velocity, dtype=float).tolist())
        for i in np.flatnonzero(of.turns).tolist():
            limits[i] = held_forces(of.rows[i], of.points, speed_of_advance(of.rows[i], nu_r), 1.0)
        return limits

    @property
    def draws_by_torque(self) -> NDArray[np.bool_]:
        """(m,) whether the torque on a propeller's shaft says what it draws: its drive or its motor is known."""
        rows = self.propellers.rows
        return self.propellers.turns & ((rows[:, MOTOR] > 0.0) | (rows[:, DRIVE] > 0.0))

    @property
    def power_known(self) -> NDArray[np.bool_]:
        """(m,) whether it is known what each draws."""
        return self.draws_by_torque | np.all(self.power_coefficients > 0.0, axis=1)

    @property
    def reactivity(self) -> NDArray[np.float64]:
        """(m,2) F_react-, F_react+ [N] per thruster."""
        return np.array([curve.reactivity for curve in self.characteristics]).reshape(-1, 2)

    def power(self, force: ArrayLike) -> NDArray[np.float64]:
        """(..., m) electrical power [W] of steady forces (..., m) [N]: k_P |F|^1.5.

        Of propellers whose torque says it: that in water which does not flow.

        A propeller's ideal power is thrust times induced speed, and that speed goes with the root of the thrust.
        Of healthy propellers: a damaged one draws what a healthy one would, for less thrust (`PowerSupply`).
        """
        F = np.asarray(force, dtype=float)
        k = np.where(F < 0.0, self.power_coefficients[:, 0], self.power_coefficients[:, 1])
        power, by_torque = k * np.abs(F) ** 1.5, self.draws_by_torque
        if by_torque.any():
            from cube_sim.vehicle.laws.propeller_power import power_of_force  # only here: it loads the compiler

            for i in np.flatnonzero(by_torque).tolist():
                row, points = self.propellers.rows[i], self.propellers.points
                for at in np.ndindex(power.shape[:-1]):
                    power[(*at, i)] = power_of_force(row, points, float(F[(*at, i)]), 0.0, 1.0)
        return power

    def energy(self, time: ArrayLike, force: ArrayLike) -> float:
        """Electrical energy [J] of forces (n,m) [N] at times (n,) [s], by the trapezoidal rule."""
        return float(np.trapezoid(self.power(force).sum(axis=-1), np.asarray(time, dtype=float)))

    def command(self, force: ArrayLike) -> NDArray[np.float64]:
        """(..., m) commands whose steady forces are `force` (..., m) [N]: the inverse characteristics.

        Raises:
            ValueError: not one number for each thruster.
        """
        from cube_sim.vehicle.laws.curve_table import commands_of_forces  # only here: it loads the compiler

        return self._each_row(commands_of_forces, self._one_each("force", force))

    def force(self, command: ArrayLike) -> NDArray[np.float64]:
        """(..., m) steady forces [N] of `command` (..., m).

        Raises:
            ValueError: not one number for each thruster.
        """
        from cube_sim.vehicle.laws.curve_table import steady_forces  # only here: it loads the compiler

        return self._each_row(steady_forces, self._one_each("command", command))

    @cached_property
    def curve_table(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The characteristics as compiled laws read them, see `cube_sim.vehicle.laws.curve_table`."""
        from cube_sim.vehicle.laws.curve_table import curve_table  # only here: it loads the compiler

        return curve_table(self.characteristics)

    def _one_each(self, name: str, values: ArrayLike) -> NDArray[np.float64]:
        """Numbers (..., m), one for each thruster."""
        try:
            numbers = np.ascontiguousarray(values, dtype=np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"{name} is {values!r:.60}; numbers are right, one for each thruster") from None
        m = len(self.names)
        if np.ndim(values) == 0 or numbers.shape[-1] != m:
            raise ValueError(
                f"{name} has shape {np.shape(values)}; the vehicle has {m} thrusters: ({m},) or (..., {m})"
            )
        if np.isnan(numbers).any():
            raise ValueError(f"{name} is not a number for {self.names[int(np.argwhere(np.isnan(numbers))[0][-1])]}")
        return numbers

    def _each_row(self, law: Callable[..., NDArray[np.float64]], numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """A law of the curves on numbers (..., m)."""
        if numbers.ndim == 1:
            return law(*self.curve_table, numbers)
        rows = [law(*self.curve_table, row) for row in numbers.reshape(-1, len(self.names))]
        return np.array(rows).reshape(numbers.shape)

    def pwm(self, force: ArrayLike) -> NDArray[np.float64]:
        """(..., m) pulse widths [us] whose steady forces are `force` (..., m) [N].

        They are not rounded. Round them yourself where whole microseconds are sent, and away from rest at the edges of
        the dead zone, where the thruster stands still.

        Raises:
            ModelError: a thruster has no `thruster_pwm`.
        """
        commands = self.command(force)
        widths = self.pwm_of_command(commands)
        for i, (curve, pulses) in enumerate(zip(self.characteristics, self._pulse_ranges(), strict=True)):
            for at in np.ndindex(commands.shape[:-1]):
                widths[(*at, i)] = _outside_dead_zone(curve, pulses, float(commands[(*at, i)]), float(widths[(*at, i)]))
        return widths

    def pwm_of_command(self, command: ArrayLike) -> NDArray[np.float64]:
        """(..., m) pulse widths [us] of normalised commands (..., m); beyond -1 and 1 they saturate.

        Raises:
            ModelError: a thruster has no `thruster_pwm`.
        """
        c, pulses = self._one_each("command", command), self._pulse_ranges()
        rows = [[float(r.pulse(x)) for r, x in zip(pulses, row, strict=True)] for row in c.reshape(-1, len(pulses))]
        return np.array(rows).reshape(c.shape)

    def command_of_pwm(self, pulse_us: ArrayLike) -> NDArray[np.float64]:
        """(..., m) normalised commands, as MuJoCo's `ctrl` takes them, of pulse widths (..., m) [us].

        Raises:
            ModelError: a thruster has no `thruster_pwm`.
        """
        widths, pulses = self._one_each("pulse_us", pulse_us), self._pulse_ranges()
        rows = [
            [float(r.command(x)) for r, x in zip(pulses, row, strict=True)] for row in widths.reshape(-1, len(pulses))
        ]
        return np.array(rows).reshape(widths.shape)

    def force_of_pwm(self, pulse_us: ArrayLike) -> NDArray[np.float64]:
        """(..., m) steady forces [N] of pulse widths (..., m) [us].

        Raises:
            ModelError: a thruster has no `thruster_pwm`.
        """
        return self.force(self.command_of_pwm(pulse_us))

    def _pulse_ranges(self) -> list[PulseRange]:
        known = [r for r in self.pulse_ranges if r is not None]
        if len(known) < len(self.names):
            name = self.names[self.pulse_ranges.index(None)]
            raise ModelError(f"{name}:thruster_pwm", "is not in the model, for this thruster or for its hull")
        return known


def _propellers(packed: NDArray[np.float64], numbers: Sequence[int]) -> PropellerTable:
    """Of thrusters with these numbers (m,) of their propellers, -1 for none."""
    turns, rows = np.array(numbers, dtype=int) >= 0, np.zeros((len(numbers), COLUMNS))
    start = int(packed[layout.PROPELLERS])
    if start < 0:
        return PropellerTable(turns, rows, np.zeros(1))
    n, k = int(packed[start]), int(packed[start + 1])
    table, points = packed[start + 2 : start + 2 + n * COLUMNS].reshape(n, COLUMNS), start + 2 + n * COLUMNS
    rows[turns] = table[[number for number in numbers if number >= 0]]
    return PropellerTable(turns, rows, packed[points : points + k].copy())


def _lag_s(model: mujoco.MjModel, actuator: int) -> float:
    two = model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_USER
    return float(model.actuator_dynprm[actuator, : 2 if two else 1].sum())


def _curve_start(packed: NDArray[np.float64], actuator: int) -> int:
    """Where the curve record of a thruster starts."""
    return int(packed[int(packed[layout.THRUSTERS]) + actuator])


def _characteristic(curve: NDArray[np.float64]) -> Characteristic:
    n = int(curve[layout.POINTS])
    commands, forces = curve[layout.CURVE : layout.CURVE + 2 * n].reshape(2, n).copy()
    zone = float(curve[layout.ZONE_LOW]), float(curve[layout.ZONE_HIGH])
    return Characteristic(commands, forces, force_dead_zone=zone)


def _pulse_range(curve: NDArray[np.float64]) -> PulseRange | None:
    widths = curve[layout.PULSE : layout.PULSE + 3]
    return None if np.isnan(widths[0]) else PulseRange(*widths.tolist())


def _outside_dead_zone(curve: Characteristic, pulses: PulseRange, command: float, pulse_us: float) -> float:
    """The pulse, moved by its last digit when rounding put a command just outside the dead zone back into it."""
    if command == 0.0:
        return pulse_us
    end = pulses.forward_us if command > 0.0 else pulses.reverse_us
    low, high = curve.command_dead_zone
    while low <= pulses.command(pulse_us) <= high and pulse_us != end:
        pulse_us = float(np.nextafter(pulse_us, end))
    return pulse_us
