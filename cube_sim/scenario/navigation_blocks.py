"""The `navigation` block: the sensors the controller flies on, and how wrong they are.

The defaults are a mid-grade set of a small vehicle: an industrial MEMS inertial unit, a 1 MHz class Doppler log, a
strain-gauge pressure sensor, a magnetic compass. Biases and scale errors are standard deviations: each run draws its
own from the scenario's seed, and the estimator knows the standard deviations only.
"""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, StringConstraints, field_validator, model_validator

from cube_sim.scenario.python_block import PythonBlock
from cube_sim.scenario.values import Block, Deviation, Noise, Place, Rate, refuse

LONGEST_DELAY_S = 10.0
LARGEST_SCALE_ERROR = 0.1
"""Up to here the estimator, linear in the scale error, is as good as it says.

The NEES of the velocity over 60 runs is 1.32 per component at 0.1, and 1.50 at 0.2, where 1.38 is the most to be
expected; at 0.3 it may be off by 7 sigma.
"""


class ImuBlock(Block):
    """Gyros and accelerometers at the body origin, read at every control period. Defaults: industrial MEMS."""

    gyro_noise_deg_s_per_sqrt_hz: Deviation = Field(
        default=0.005, description="Density of the gyros' white noise [deg/s/sqrt(Hz)]."
    )
    gyro_bias_deg_s: Deviation = Field(default=0.1, description="Standard deviation of the gyros' bias [deg/s].")
    gyro_bias_walk_deg_s2_per_sqrt_hz: Deviation = Field(
        default=0.0003, description="Random walk of the gyros' bias: density of its rate [deg/s^2/sqrt(Hz)]."
    )
    accelerometer_noise_m_s2_per_sqrt_hz: Deviation = Field(
        default=0.0006, description="Density of the accelerometers' white noise [m/s^2/sqrt(Hz)]."
    )
    accelerometer_bias_m_s2: Deviation = Field(
        default=0.02, description="Standard deviation of the accelerometers' bias [m/s^2]."
    )
    accelerometer_bias_walk_m_s3_per_sqrt_hz: Deviation = Field(
        default=0.0001, description="Random walk of the accelerometers' bias [m/s^3/sqrt(Hz)]."
    )


class AidBlock(Block):
    """What every sensor beside the inertial unit has."""

    rate_hz: Rate
    delay_s: float


def _rate(default: float) -> Any:
    return Field(default=default, description="Readings per second [Hz], at most one per control period.")


def _delay(default: float) -> Any:
    text = "From the instant of a reading to its arrival [s]; the estimator knows it."
    return Field(default=default, ge=0, le=LONGEST_DELAY_S, description=text)


class DvlBlock(AidBlock):
    """Doppler log with bottom track: velocity over ground, body axes. Defaults: a 1 MHz class."""

    rate_hz: Rate = _rate(5.0)
    noise_m_s: Noise = Field(default=0.01, description="Standard deviation of a reading, each axis [m/s].")
    bias_m_s: Deviation = Field(default=0.002, description="Standard deviation of the bias, each axis [m/s].")
    scale_error: float = Field(
        default=0.005,
        ge=0,
        le=LARGEST_SCALE_ERROR,
        description="Standard deviation of the scale error, a share of the velocity.",
    )
    delay_s: float = _delay(0.1)
    lever_arm_m: Place = Field(default=(0.0, 0.0, 0.0), description="Where it sits, body axes from the origin [m].")


class DepthBlock(AidBlock):
    """Pressure gauge, read as depth below z = 0. Defaults: a strain gauge, air pressure known to 5 hPa."""

    rate_hz: Rate = _rate(10.0)
    noise_m: Noise = Field(default=0.01, description="Standard deviation of a reading [m].")
    bias_m: Deviation = Field(default=0.05, description="Standard deviation of the bias [m].")
    delay_s: float = _delay(0.05)


class HeadingBlock(AidBlock):
    """Compass: the azimuth of the body's x axis; none while that points steeply up or down. Defaults: magnetic."""

    rate_hz: Rate = _rate(10.0)
    noise_deg: Noise = Field(default=0.5, description="Standard deviation of a reading [deg].")
    bias_deg: Deviation = Field(default=2.0, description="Standard deviation of the bias [deg].")
    delay_s: float = _delay(0.05)


class PositionFixBlock(AidBlock):
    """Acoustic fix in world axes. Defaults: an ultra-short baseline at some tens of metres."""

    rate_hz: Rate = _rate(0.5)
    noise_m: Noise = Field(default=0.5, description="Standard deviation of a reading, each axis [m].")
    delay_s: float = _delay(0.5)


class OwnSensorBlock(PythonBlock, AidBlock):
    """A sensor of one's own. What it makes is asked for the reading without errors; see docs/extending.md."""

    name: Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)] = Field(
        description="One word; the channel of its readings is `sensor_NAME`."
    )
    rate_hz: Rate = _rate(1.0)
    components: int = Field(default=1, ge=1, le=3, description="Numbers in a reading.")
    unit: str = Field(default="1", min_length=1, max_length=20, description="Unit of a reading, for the record.")
    noise: float = Field(ge=1e-6, le=1e6, description="Standard deviation of each number of a reading, in its unit.")
    bias: float = Field(default=0.0, ge=0, le=1e6, description="Standard deviation of each number's bias, in its unit.")
    angle: bool = Field(
        default=False, description="Whether the reading is an angle [rad]: differences go the short way round."
    )
    delay_s: float = _delay(0.0)


class InitialEstimateBlock(Block):
    """How well the state is known at time 0; the first estimate is off by a drawn error of this size."""

    position_m: Deviation = Field(default=0.5, description="Standard deviation of each axis [m].")
    velocity_m_s: Deviation = Field(default=0.05, description="Standard deviation of each axis [m/s].")
    tilt_deg: Deviation = Field(default=1.0, description="Standard deviation of the vertical, each axis [deg].")
    heading_deg: Deviation = Field(default=3.0, description="Standard deviation of the heading [deg].")


class NavigationBlock(Block):
    """Sensors and an estimate made of them; the controller sees the estimate only. A sensor set to null is left out."""

    imu: ImuBlock = Field(default=ImuBlock(), description="Inertial unit; it cannot be left out.")
    dvl: DvlBlock | None = Field(default=DvlBlock(), description="Doppler log.")
    depth: DepthBlock | None = Field(default=DepthBlock(), description="Pressure gauge.")
    heading: HeadingBlock | None = Field(default=HeadingBlock(), description="Compass.")
    position: PositionFixBlock | None = Field(
        default=None, description="Acoustic position fix. Default: none, position is dead-reckoned."
    )
    own: tuple[OwnSensorBlock, ...] = Field(
        default=(), strict=False, description="Sensors of one's own, in Python. Default: none."
    )
    initial: InitialEstimateBlock = Field(default=InitialEstimateBlock(), description="What is known at time 0.")

    @property
    def aids(self) -> dict[str, AidBlock]:
        """The sensors beside the inertial unit, by name, in the order of their keys."""
        named = {name: block for name, block in self if isinstance(block, AidBlock)}
        return named | {sensor.name: sensor for sensor in self.own}

    @field_validator("imu", mode="before")
    @classmethod
    def _inertial_unit(cls, imu: Any) -> Any:
        if imu is None:
            refuse("no estimate without an inertial unit: it alone says how the vehicle turns between two readings")
        return imu

    @model_validator(mode="after")
    def _velocity_is_seen(self) -> Self:
        taken = {*type(self).model_fields, "telemetry"}  # that one's random numbers go by this name
        for index, sensor in enumerate(self.own):
            if sensor.name in taken:
                refuse(f"there is a sensor {sensor.name} already", "own", index, "name")
            taken.add(sensor.name)
        if self.dvl is None and self.position is None and not self.own:
            refuse("nothing sees the velocity, so the position is lost within a minute: give dvl or position", "dvl")
        return self


def require_slower_than(navigation: NavigationBlock, control_period_s: float) -> None:
    """Refuse a sensor that reads more often than the loop looks."""
    own = {sensor.name: ("own", index) for index, sensor in enumerate(navigation.own)}
    for name, aid in navigation.aids.items():
        if aid.rate_hz * control_period_s > 1.0 + 1e-9:
            refuse(
                f"must be at most one reading per control period: {aid.rate_hz:g} Hz against"
                f" {1.0 / control_period_s:g} Hz",
                *own.get(name, (name,)),
                "rate_hz",
                because=("control_period_s",),
            )
