"""The `sensor` event: a sensor that the controller flies on fails, or comes back."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from cube_sim.scenario.event_block import EventBlock
from cube_sim.scenario.values import Coordinate, Numbers, Seconds, refuse

SensorState = Literal["lost", "zeros", "frozen", "outliers", "late", "biased", "recovered"]
_NEEDS = {"outliers": ("share", "size"), "late": ("delay_s",), "biased": ("offset",)}
_WHILE = "tilt_above_deg", "deeper_than_m", "shallower_than_m"


class SensorEventBlock(EventBlock):
    """A sensor of the `navigation` block fails, or comes back; the estimator does not know of it.

    Faults of different states add up. Healthy readings are the same numbers as without any fault.
    """

    kind: Literal["sensor"]
    sensor: str = Field(
        min_length=1,
        max_length=40,
        description="Which: imu, dvl, depth, heading, position, or the name of a sensor of one's own.",
    )
    state: SensorState = Field(
        description="lost: no readings; zeros: it reads 0; frozen: it repeats its last reading; outliers: some readings"
        " are far off; late: its readings are older than it says; biased: something is added to each; recovered: whole,"
        " whatever was wrong. The inertial unit can read zeros, freeze, be biased and recover."
    )
    for_s: Seconds | None = Field(
        default=None, description="How long [s]. Default: until it is recovered, or to the end."
    )
    tilt_above_deg: float | None = Field(
        default=None,
        gt=0,
        lt=180,
        description="Lost only while the vehicle's z axis is further from the vertical than this [deg]. Of several"
        " such conditions one is enough.",
    )
    deeper_than_m: Coordinate | None = Field(
        default=None, description="Lost only while the vehicle is deeper than this below z = 0 [m]."
    )
    shallower_than_m: Coordinate | None = Field(
        default=None,
        description="Lost only while it is less deep [m]: where the bottom is out of range of a Doppler log, for one.",
    )
    share: float | None = Field(default=None, gt=0, le=1, description="Share of the readings that are outliers.")
    size: float | None = Field(
        default=None,
        gt=0,
        le=1e6,
        description="Standard deviation of what each number of an outlier is off by, in the reading's unit: m/s, m;"
        " deg of a heading.",
    )
    delay_s: float | None = Field(
        default=None, gt=0, le=600, description="By how much readings are older than the sensor says [s]."
    )
    offset: Numbers | None = Field(
        default=None,
        description="What is added to each number of a reading, in its unit: m/s, m; deg of a heading; of the inertial"
        " unit three of deg/s and three of m/s^2.",
        json_schema_extra={"minItems": 1},
    )

    @model_validator(mode="after")
    def _what_the_state_needs(self) -> SensorEventBlock:
        for state, keys in _NEEDS.items():
            for key in keys:
                given = getattr(self, key) is not None
                if given != (self.state == state):
                    refuse(f"{key} and state {state} go together: give both or neither", key if given else "state")
        for key in _WHILE:
            if getattr(self, key) is not None and self.state != "lost":
                refuse(f"says while what a sensor is lost; its state is {self.state}", key)
        deeper, shallower = self.deeper_than_m, self.shallower_than_m
        if deeper is not None and shallower is not None and deeper < shallower:
            text = f"deeper than {deeper:g} m or less deep than {shallower:g} m is every depth: leave both out"
            refuse(text, "shallower_than_m")
        if self.for_s is not None and self.state == "recovered":
            refuse("a sensor that is recovered stays so: leave it out", "for_s")
        return self

    @property
    def what(self) -> str:
        """See `TitledBlock.what`."""
        told = {
            "outliers": f", {100 * (self.share or 0.0):g} % of the readings",
            "late": f" by {self.delay_s or 0.0:g} s",
            "biased": f" by {list(self.offset or ())}",
        }
        limits = [
            (self.tilt_above_deg, "tilted beyond {:g} deg"),
            (self.deeper_than_m, "deeper than {:g} m"),
            (self.shallower_than_m, "less deep than {:g} m"),
        ]
        within = " or ".join(text.format(limit) for limit, text in limits if limit is not None)
        lasts = "" if self.for_s is None else f", for {self.for_s:g} s"
        return f"{self.sensor}: {self.state}{told.get(self.state, '')}{f' while {within}' * bool(within)}{lasts}"

    @property
    def ends(self) -> tuple[float, str] | None:
        """See `EventBlock.ends`."""
        over = f"{self.sensor}: no longer {self.state}" if self.name is None else f"{self.name}: over"
        return (
            None
            if self.for_s is None
            else (self.at_s + self.for_s, over if self.name is None else f"{self.name}: over")
        )
