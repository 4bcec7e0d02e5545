"""A scenario's `navigation` block at work: the truth read from MuJoCo, the estimate for the controller, its record."""

from __future__ import annotations

from math import radians
from typing import Any

import numpy as np

from cube_sim.guidance.path import Path
from cube_sim.navigation.aid import Aid
from cube_sim.navigation.depth import Depth
from cube_sim.navigation.dvl import Dvl
from cube_sim.navigation.estimating import NavigationMemory, NavigationParameters
from cube_sim.navigation.faults import SensorFaults
from cube_sim.navigation.heading import LEAST_LEVEL_PART, Heading
from cube_sim.navigation.imu import ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.navigator import InitialErrors, Navigator
from cube_sim.navigation.observability import what_drifts
from cube_sim.navigation.own_aid import OwnAid
from cube_sim.navigation.position import PositionFix
from cube_sim.navigation.reading import ReadingOutcome
from cube_sim.navigation.sampling import Sampling
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.navigation_channels import navigation_channels
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import Scenario
from cube_sim.scenario import navigation_blocks as blocks
from cube_sim.scenario.attitude_blocks import AlongPathBlock, AnyAttitude, FixedAttitudeBlock
from cube_sim.spatial import Matrix, Record, State, Vector, quaternion_from_euler, rotation_from_quaternion
from cube_sim.tuples import turned_to_world
from cube_sim.vehicle.vehicle import Vehicle

STATIONS = 501
"""Places at which the direction of a path is looked at."""


class StateEstimation:
    """Gives a controller that flies on sensors its estimate of the true state, and records both.

    Args:
        block: the scenario's `navigation`.
        vehicle: the hull that carries the sensors.
        seed: root of their random streams.
        period_s: the control period.
        drifts: what of the estimate is held by what, in words.
        own: sensors of the user's own.
        faults: of the sensors, which events change; None: they stay whole.

    Attributes:
        own: the same.
    """

    def __init__(
        self,
        block: blocks.NavigationBlock,
        vehicle: Vehicle,
        seed: int,
        period_s: float,
        drifts: str,
        own: tuple[OwnAid, ...] = (),
        faults: SensorFaults | None = None,
    ) -> None:
        self._faults = faults
        self._block, self._vehicle, self._seed, self._period, self.own = block, vehicle, seed, period_s, own
        self._drifts = drifts
        self._navigator: Navigator | None = None
        self._in_doubt: set[str] = set()

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        vehicle: Vehicle,
        path: Path,
        own: tuple[OwnAid, ...] = (),
        faults: SensorFaults | None = None,
    ) -> StateEstimation | None:
        """As the scenario says, with its sensors of the user's own; None when its controller sees the true state."""
        block = scenario.navigation
        if block is None:
            return None
        drifts = what_drifts(block.aids, nose_level_share(scenario.control.attitude, path), moves_level(path))
        return cls(block, vehicle, scenario.seed, scenario.control_period_s, drifts, own, faults)

    def reseed(self, seed: int) -> None:
        """Start all sensors and the estimate anew."""
        self._seed, self._navigator = seed, None
        self._in_doubt.clear()

    def estimate(self, true: State, recorder: SignalStore, t: float) -> State:
        """The estimated state; once per tick.

        Args:
            true: the vehicle's state.
            recorder: gets the estimate, its error and the readings that have arrived.
            t: simulated time [s].

        Raises:
            OwnCodeError: a sensor of the user's own has no answer.
        """
        truth = motion_of(true)
        if self._navigator is None:
            self._navigator = self._start(truth, recorder, t)
        navigator = self._navigator
        arrived = navigator.update(truth)
        failures = [error for sensor in self.own for error in sensor.failures]
        if failures:
            for sensor in self.own:
                sensor.failures.clear()  # the first is told; no other may end the next flight
            raise failures[0]
        self.note(arrived, recorder, t)
        answer = navigator.answer
        self.record(recorder, np.array([t]), answer, navigator.error, navigator.inertial[None])
        return estimated(answer[0])

    @property
    def position_sigma_m(self) -> float:
        """Standard deviation of the estimated position along its least known axis, as the filter believes it [m]."""
        navigator = self._navigator
        return 0.0 if navigator is None else float(np.sqrt(np.max(np.diag(navigator.filter.P)[:3])))

    def stage(self, ticks: int) -> tuple[NavigationParameters, NavigationMemory] | None:
        """The first arguments of `cube_sim.navigation.estimating.estimate` for so many ticks.

        None before the first, and with a sensor of the user's own: what that raises is looked for after each tick.
        """
        return None if self._navigator is None or self.own else self._navigator.stage(ticks)

    def record(self, recorder: SignalStore, t: Vector, answers: Record, errors: Record, inertial: Matrix) -> None:
        """Record the estimates of n ticks of one simulated second, but for the readings.

        Args:
            recorder: gets them.
            t: (n,) simulated time [s].
            answers: (n,) of `cube_sim.navigation.estimating.ESTIMATE`.
            errors: (n,) of `ERROR`.
            inertial: (n,9) readings of the inertial unit.
        """
        tables = _columns(t, answers), _columns(t, errors), np.column_stack([t, inertial])
        names = "navigation", "navigation_error", "sensor_imu"
        recorder.extend(float(t[0]), float(t[-1]), zip(names, tables, strict=True))

    def note(self, arrived: Record, recorder: SignalStore, t: float) -> None:
        """Record the readings that have arrived at one tick.

        Args:
            arrived: (c,) of `cube_sim.navigation.reading.READING`.
            recorder: gets them.
            t: simulated time [s].
        """
        if self._navigator is not None:
            for reading in arrived.tolist():
                self._record_reading(self._navigator.aids[reading[0]], reading, recorder, t)

    def _start(self, truth: Motion, recorder: SignalStore, t: float) -> Navigator:
        block = self._block
        recorder.log(t, "INFO", f"navigation: {self._drifts}")
        return Navigator(
            imu=_imu(block.imu),
            aids=[*(_aid(aid) for aid in block.aids.values() if not isinstance(aid, blocks.OwnSensorBlock)), *self.own],
            initial=_initial(block.initial),
            truth=truth,
            seed=self._seed,
            gravity=self._vehicle.gravity,
            period_s=self._period,
            faults=self._faults,
        )

    def _record_reading(self, aid: Aid, reading: tuple[Any, ...], recorder: SignalStore, t: float) -> None:
        """Record the numbers of an element of `cube_sim.navigation.reading.READING`."""
        name, n = aid.name, slice(aid.components) if aid.components > 1 else 0
        _, tick, _, value, innovation, nis, outcome = reading
        recorder.append(f"sensor_{name}", t, value[n], tick * self._period, innovation[n], nis, outcome)
        if outcome == ReadingOutcome.ACCEPTED_AFTER_REJECTIONS and name not in self._in_doubt:
            self._in_doubt.add(name)
            text = f"navigation: {name} contradicts the estimate again and again; it is believed, the estimate doubted"
            recorder.log(t, "WARNING", text)
        elif outcome == ReadingOutcome.FUSED and name in self._in_doubt:
            self._in_doubt.remove(name)
            recorder.log(t, "INFO", f"navigation: {name} and the estimate agree again")


def estimated(answer: np.void) -> State:
    """The state in an element of `cube_sim.navigation.estimating.ESTIMATE`."""
    return State(*(answer[name] for name in State._fields))


def _columns(t: Vector, numbers: Record) -> Matrix:
    """A table of the times (n,) and of the fields of (n,) records, the rotation apart, which is told by another."""
    fields = (numbers[name].reshape(len(t), -1) for name in numbers.dtype.names or () if name != "rotation")
    return np.column_stack([t, *fields])


def channels_of(block: blocks.NavigationBlock | None) -> tuple[Channel, ...]:
    """What navigation will record; nothing without it."""
    if block is None:
        return ()
    read = "what it reads; see the code in the recording"
    own = {sensor.name: Field("reading", sensor.components, sensor.unit, read) for sensor in block.own}
    return navigation_channels({name: aid.rate_hz for name, aid in block.aids.items()}, own)


def nose_level_share(attitude: AnyAttitude, path: Path) -> float | None:
    """Share of the path on which a compass reads in the attitude asked for; None where only the flight shows it."""
    if isinstance(attitude, FixedAttitudeBlock):
        nose = rotation_from_quaternion(quaternion_from_euler(*np.radians(attitude.attitude_deg)))[:, 0]
        return float(np.hypot(*nose[:2]) >= LEAST_LEVEL_PART)
    if not isinstance(attitude, AlongPathBlock):
        return None
    return float(np.mean(_level_parts(path) >= LEAST_LEVEL_PART))


def moves_level(path: Path) -> bool:
    """Whether the path goes anywhere but up and down."""
    return bool(path.length) and bool(_level_parts(path).max() >= LEAST_LEVEL_PART)


def _level_parts(path: Path) -> Vector:
    """The level part of the path's direction, at places all along it."""
    return np.array([np.hypot(*path.at(s).rotation[:2, 0]) for s in np.linspace(0.0, path.length, STATIONS)])


def motion_of(state: State) -> Motion:
    """A state as sensors at the body origin feel it."""
    return Motion(state.position, turned_to_world(state.rotation, state.velocity), state.rotation, state.rates)


def _imu(block: blocks.ImuBlock) -> ImuErrors:
    return ImuErrors(
        gyro_noise=radians(block.gyro_noise_deg_s_per_sqrt_hz),
        accelerometer_noise=block.accelerometer_noise_m_s2_per_sqrt_hz,
        gyro_bias=radians(block.gyro_bias_deg_s),
        accelerometer_bias=block.accelerometer_bias_m_s2,
        gyro_bias_walk=radians(block.gyro_bias_walk_deg_s2_per_sqrt_hz),
        accelerometer_bias_walk=block.accelerometer_bias_walk_m_s3_per_sqrt_hz,
    )


def _aid(block: blocks.AidBlock) -> Aid:
    sampling = Sampling(block.rate_hz, block.delay_s)
    match block:
        case blocks.DvlBlock():
            return Dvl(sampling, block.noise_m_s, block.bias_m_s, block.scale_error, block.lever_arm_m)
        case blocks.DepthBlock():
            return Depth(sampling, block.noise_m, block.bias_m)
        case blocks.HeadingBlock():
            return Heading(sampling, radians(block.noise_deg), radians(block.bias_deg))
        case blocks.PositionFixBlock():
            return PositionFix(sampling, block.noise_m)
    raise TypeError(f"no sensor is built from {type(block).__name__}")


def _initial(block: blocks.InitialEstimateBlock) -> InitialErrors:
    return InitialErrors(
        position=block.position_m,
        velocity=block.velocity_m_s,
        tilt=radians(block.tilt_deg),
        heading=radians(block.heading_deg),
    )
