"""A mission's fault diagnosis at work: what the thrusters should give against what they give."""

from __future__ import annotations

from math import sqrt

import mujoco
import numpy as np

from cube_sim.control.diagnosis import AT_ONCE_S, AT_ONCE_TICKS, Diagnosis, Window
from cube_sim.control.probing import ProbeMemory
from cube_sim.control.window_reading import FAR
from cube_sim.mission.hull import CompiledHull
from cube_sim.mission.telemetry import Telemetry
from cube_sim.scenario import Scenario
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.laws.inflow import Inflow, whole_forces
from cube_sim.vehicle.thrusters import Thrusters
from cube_sim.wrench.health import Health

PROBE_S, PROBE_LAGS = 0.3, 3.0
"""The most a probe takes [s]; of slow thrusters so many times their lag: then they make 95 % of what is asked."""
WINDOW_S = 0.5
"""Evidence needed [s]."""
LEAST_THRESHOLD_N = 0.5
"""Differences below this are no evidence [N]: no characteristic is known better."""
FAINT, FAINT_S = 4.0, 6.0
"""A fault that is no more than so many times what says nothing counts as one that goes on for so long [s]: by then the
observer of the disturbance has answered it, whether or not anybody has found it."""


class FaultFinding:
    """Finds the faults of a hull's thrusters.

    Args:
        flown: the hull.
        scenario: the mission.
        inflow: of its thrusters, as last felt.
    """

    def __init__(self, flown: CompiledHull, scenario: Scenario, inflow: Inflow) -> None:
        self._inflow = inflow
        self._thrusters = flown.vehicle.thrusters
        self._telemetry = Telemetry(scenario.telemetry, len(self._thrusters.names), scenario.seed)
        self._diagnosis = _diagnosis(self._thrusters, scenario)

    def reseed(self, seed: int) -> None:
        """Start the noise of the telemetry anew."""
        self._telemetry.reseed(seed)

    def judge(self, data: mujoco.MjData, force_ratio: float, share: float) -> Health:
        """What is believed of the thrusters; once per tick.

        Args:
            data: MuJoCo's, up to date.
            force_ratio: the share of the forces expected of them that the supply leaves them.
            share: the same of their characteristics' forces, also where what is expected counts it in.
        """
        measured = self._telemetry.read(data.actuator_force[self._thrusters.actuators])
        if force_ratio == 0.0:
            return self._diagnosis.health
        commands = data.act[self._thrusters.activations]
        if self._inflow.varies:
            expected = whole_forces(self._inflow, share, commands, measured, self._diagnosis.health.efficiency)
        else:
            expected = self._thrusters.force(commands)
        return self._diagnosis.update(expected, measured, force_ratio)

    def conclude(self, force_ratio: float) -> Health:
        """The same when the forces of this tick have been entered already."""
        return self._diagnosis.conclude(force_ratio)

    def evidence(self, ticks: int) -> tuple[Window, ProbeMemory, Vector, Matrix] | None:
        """What it judges by, its probes, the gains (m,) of the telemetry and its noise (ticks, m) [N] to come.

        None where Python has to judge. `take_over` says of how many ticks the forces have been entered.
        """
        window, telemetry = self._diagnosis.window, self._telemetry
        return (
            None if window is None else (window, self._diagnosis.probes, telemetry.gain, telemetry.noise_ahead(ticks))
        )

    def take_over(self, ticks: int) -> None:
        """Go on from where the forces of so many ticks have been entered into the evidence."""
        self._telemetry.skip(ticks)

    def probed(self, force: Vector) -> Vector:
        """The forces (m,) [N] to ask for at this tick, a probe among them when one is due."""
        return self._diagnosis.probed(force)


def _diagnosis(thrusters: Thrusters, scenario: Scenario) -> Diagnosis:
    """Differences beyond the dead zone count, within which no thruster's force is certain."""
    limits, threshold = thrusters.limits, threshold_N(thrusters)
    least, most = limits[:, 0], limits[:, 3]
    period, noise = scenario.control_period_s, scenario.telemetry.noise_N
    # Three times what says nothing: an answer is seen within a few control periods, and the probe is over. Under noise
    # as much as shows the share of it to a thirtieth, one standard deviation, in the readings of a probe.
    length = probe_s(thrusters)
    readings = max(1, round(length / period))
    size = max(3.0 * threshold, 30.0 * noise / sqrt(readings))
    probe = np.where(most >= -least, np.minimum(size, most), np.maximum(-size, least))
    return Diagnosis(WINDOW_S, threshold, period, probe, noise, scenario.telemetry.gain_tolerance, length)


def threshold_N(thrusters: Thrusters) -> float:
    """Differences between expected and measured forces below this say nothing [N]."""
    return max(LEAST_THRESHOLD_N, 1.2 * float(np.abs(thrusters.limits[:, 1:3]).max(initial=0.0)))


def probe_s(thrusters: Thrusters) -> float:
    """The most a probe takes [s]."""
    return max(PROBE_S, PROBE_LAGS * float(np.max(thrusters.lag_s, initial=0.0)))


def found_within_s(thrusters: Thrusters, asked_N: float, given_N: float, period_s: float) -> float:
    """By when a thruster is found to give another force than the one it is asked for [s], its telemetry without noise.

    Far from all that a working one gives, the first readings tell. Else a window has to be full of it, and may have to
    be full a second time, after a probe. What is little more than what says nothing is found late, or never.

    Args:
        thrusters: of the vehicle.
        asked_N: what it is asked for when the fault comes [N].
        given_N: what it gives from then on [N].
        period_s: of the control [s].
    """
    threshold = threshold_N(thrusters)
    far = FAR * threshold
    if given_N > 1.1 * max(asked_N, 0.0) + far or given_N < 1.1 * min(asked_N, 0.0) - far:
        return max(AT_ONCE_S, AT_ONCE_TICKS * period_s) + 2.0 * period_s
    if abs(given_N - asked_N) > FAINT * threshold:
        return 2.0 * (WINDOW_S + period_s) + probe_s(thrusters)
    return FAINT_S
