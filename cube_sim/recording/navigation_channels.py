"""The channels of a run that is flown on an estimate: the estimate, its error, and the readings of each sensor."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from cube_sim.recording.channels import WXYZ, XYZ, Channel, Field


class SensorReading(NamedTuple):
    """What a sensor beside the inertial unit records.

    Attributes:
        instrument: what it is, for readers.
        field: its reading.
    """

    instrument: str
    field: Field


READINGS = {
    "dvl": SensorReading(
        "Doppler log", Field("velocity", 3, "m/s", "velocity of the sensor over ground as read, body axes", XYZ)
    ),
    "depth": SensorReading("pressure gauge", Field("depth", 1, "m", "depth below z = 0 as read, positive downwards")),
    "heading": SensorReading(
        "compass", Field("heading", 1, "rad", "azimuth of the body's x axis as read, from world x towards y")
    ),
    "position": SensorReading("position fix", Field("position", 3, "m", "position fix as read, world axes", XYZ)),
}
"""What each sensor beside the inertial unit reads, by its name."""

OUTCOMES = ("FUSED", "REJECTED", "ACCEPTED_AFTER_REJECTIONS")


NONE_OF_ONES_OWN: Mapping[str, Field] = MappingProxyType({})


def navigation_channels(
    rates_hz: Mapping[str, float], own: Mapping[str, Field] = NONE_OF_ONES_OWN
) -> tuple[Channel, ...]:
    """Declare what navigation records beside the channels of every run.

    Args:
        rates_hz: rate of each sensor beside the inertial unit, by name.
        own: what sensors of the user's own read, by name.
    """
    return (
        Channel(
            "navigation",
            (
                Field("position", 3, "m", "estimated p_WB, world axes", XYZ),
                Field("quaternion", 4, "1", "estimated q_WB, body to world", WXYZ),
                Field("linear", 3, "m/s", "estimated velocity over ground, estimated body axes", XYZ),
                Field("angular", 3, "rad/s", "estimated angular velocity, body axes", XYZ),
                Field("position_sigma", 3, "m", "standard deviation of the position, world axes", XYZ),
                Field("velocity_sigma", 3, "m/s", "standard deviation of the velocity, world axes", XYZ),
                Field(
                    "attitude_sigma", 3, "rad", "standard deviation of the attitude's rotation vector, world axes", XYZ
                ),
                Field("gyro_bias", 3, "rad/s", "estimated bias of the gyros", XYZ),
                Field("accelerometer_bias", 3, "m/s^2", "estimated bias of the accelerometers", XYZ),
            ),
        ),
        Channel(
            "navigation_error",
            (
                Field("position", 3, "m", "estimated less true position, world axes", XYZ),
                Field("velocity", 3, "m/s", "estimated less true velocity, world axes", XYZ),
                Field("attitude", 3, "rad", "rotation vector from the true to the estimated attitude, world axes", XYZ),
                Field("gyro_bias", 3, "rad/s", "estimated less true bias of the gyros", XYZ),
                Field("accelerometer_bias", 3, "m/s^2", "estimated less true bias of the accelerometers", XYZ),
            ),
        ),
        Channel(
            "sensor_imu",
            (
                Field("mean_rates", 3, "rad/s", "turn since the tick before as read, over the time, body axes", XYZ),
                Field(
                    "specific_force",
                    3,
                    "m/s^2",
                    "mean acceleration less gravity since the tick before as read, body axes of then",
                    XYZ,
                ),
                Field("rates", 3, "rad/s", "angular velocity at the tick as read, body axes", XYZ),
            ),
        ),
        *(_sensor(name, rate, own[name] if name in own else READINGS[name].field) for name, rate in rates_hz.items()),
    )


def _sensor(name: str, rate_hz: float, reading: Field) -> Channel:
    """Rows come when readings arrive."""
    return Channel(
        f"sensor_{name}",
        (
            reading,
            Field("taken_at", 1, "s", "when the sensor looked; the row's own time is when the reading was there"),
            Field("innovation", reading.width, reading.unit, "what it said beyond the estimate", reading.columns),
            Field("surprise", 1, "1", "the innovation's square in units of its covariance, chi-square"),
            Field("outcome", 1, "1", "fused, kept out by the gate, or fused although the gate would not", (), OUTCOMES),
        ),
        rate_hz,
    )
