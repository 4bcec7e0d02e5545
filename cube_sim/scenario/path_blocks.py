"""The `path` block: which curve the vehicle follows, told apart by `type`."""

from __future__ import annotations

from collections.abc import Callable
from math import dist, hypot, pi
from pathlib import Path as FilePath
from typing import Annotated, Literal, TypeVar

from pydantic import Field, field_validator, model_validator
from pydantic.types import Strict
from pydantic_core.core_schema import ValidationInfo

from cube_sim.errors import PathError
from cube_sim.scenario.file_names import TableFile
from cube_sim.scenario.python_block import PythonBlock
from cube_sim.scenario.values import Angle, Block, Direction, Extent, Place, Vector3, refuse, require_direction

Laps = Annotated[float, Field(ge=1e-3, le=1e6)]
Waypoints = Annotated[tuple[Place, ...], Strict(False)]
LAPS = "How many times round; default: again and again until the run ends. Only for a closed path."
CORNER = "Smallest radius of curvature of the rounded corners [m]."
SHORTEST_M, LONGEST_M = 0.01, 1e6
"""Of a path, and of a radius along it."""
Result = TypeVar("Result")


def accept(make: Callable[[], Result], *below: str | int) -> Result:
    """Run a check of `cube_sim.guidance`, its mistake becoming one at this place in the file."""
    try:
        return make()
    except PathError as error:
        refuse(str(error), *below, *error.below)


def _require_length(length_m: float) -> None:
    if not SHORTEST_M <= length_m <= LONGEST_M:
        refuse(f"the path would be some {length_m:.3g} m long; {SHORTEST_M:g} to {LONGEST_M:g} m make sense")


class LineBlock(Block):
    """A straight segment."""

    type: Literal["line"]
    start_m: Place = Field(description="First point, world axes [m].")
    end_m: Place = Field(description="Last point, world axes [m]; differs from start_m.")

    @field_validator("end_m")
    @classmethod
    def _has_length(cls, end_m: Place, info: ValidationInfo) -> Place:
        start_m = info.data.get("start_m")
        if end_m == start_m:
            refuse(f"a line needs two different points, start_m and end_m are both {list(end_m)}")
        if start_m is not None and dist(start_m, end_m) < SHORTEST_M:
            refuse(f"a line is {SHORTEST_M:g} m long or longer, this one {dist(start_m, end_m):g} m")
        return end_m


class PointBlock(Block):
    """A point to stay at: the path of a vehicle that goes nowhere."""

    type: Literal["point"]
    position_m: Place = Field(description="Where to stay, world axes [m].")
    heading_deg: Angle = Field(
        default=0.0, description="Which way is along the path, from world x towards world y [deg]."
    )


class ArcBlock(Block):
    """A part of a circle in any plane, through three points."""

    type: Literal["arc"]
    start_m: Place = Field(description="First point, world axes [m].")
    through_m: Place = Field(description="A point between, not on the line from start_m to end_m [m].")
    end_m: Place = Field(description="Last point [m].")

    @model_validator(mode="after")
    def _curved(self) -> ArcBlock:
        from cube_sim.guidance.arc import arc_through

        arc = accept(lambda: arc_through(self.start_m, self.through_m, self.end_m))
        _require_length(arc.length)
        return self


class CircleBlock(Block):
    """A closed circle in any plane, run round and round."""

    type: Literal["circle"]
    centre_m: Place = Field(description="Centre, world axes [m].")
    radius_m: Extent = Field(description="Radius [m].")
    axis: Direction = Field(
        default=(0.0, 0.0, 1.0),
        description="Direction square to the circle's plane, of any length; the circle is seen from its tip.",
    )
    start_angle_deg: Angle = Field(
        default=0.0,
        description="Where the path starts: about the axis, from world x laid into the plane [deg].",
    )
    direction: Literal["left", "right"] = Field(
        default="left", description="Seen from the tip of the axis: left turns counter-clockwise, right clockwise."
    )
    laps: Laps | None = Field(default=None, description=LAPS)

    @field_validator("axis")
    @classmethod
    def _has_a_direction(cls, axis: Vector3) -> Vector3:
        return require_direction(axis, "the axis of a circle")


class HelixBlock(Block):
    """A circular helix about a vertical axis; with pitch_m 0 it is a horizontal circle with two ends."""

    type: Literal["helix"]
    centre_m: Place = Field(
        description="Centre of the circle on which the helix starts: a point of the axis, world axes [m]."
    )
    radius_m: Extent = Field(description="Distance of the path from its axis [m].")
    pitch_m: float = Field(ge=-1e5, le=1e5, description="Rise along world z in one turn [m]; negative descends.")
    turns: float = Field(gt=0, le=1e4, description="Number of turns; fractions are welcome.")
    start_angle_deg: Angle = Field(
        default=0.0, description="Where on the circle the path starts, from world x towards world y [deg]."
    )
    direction: Literal["left", "right"] = Field(
        default="left", description="Seen from above: left turns counter-clockwise, right clockwise."
    )

    @model_validator(mode="after")
    def _has_a_length(self) -> HelixBlock:
        _require_length(self.turns * hypot(2.0 * pi * self.radius_m, self.pitch_m))
        return self


class SinusoidBlock(Block):
    """A level sine wave about a straight axis; its tightest bend has a radius of wavelength^2 / (4 pi^2 amplitude)."""

    type: Literal["sinusoid"]
    start_m: Place = Field(description="Where it starts, on its axis, world axes [m].")
    heading_deg: Angle = Field(default=0.0, description="Direction of the axis, from world x towards world y [deg].")
    amplitude_m: float = Field(
        ge=-1e5, le=1e5, description="Largest distance from the axis [m]; negative begins to the right."
    )
    wavelength_m: Extent = Field(description="Length of one wave along the axis [m].")
    periods: float = Field(gt=0, le=1000, description="Number of waves; fractions are welcome.")

    @model_validator(mode="after")
    def _can_be_followed(self) -> SinusoidBlock:
        tightest = self.wavelength_m**2 / (4.0 * pi**2 * max(abs(self.amplitude_m), 1e-300))
        if tightest < SHORTEST_M:
            text = f"bends with a radius of {tightest:.3g} m, which must be {SHORTEST_M:g} m or more"
            refuse(text, "amplitude_m")
        _require_length(self.periods * hypot(self.wavelength_m, 4.0 * self.amplitude_m))
        return self


class ClosablePathBlock(Block):
    """What paths through points share."""

    closed: bool = Field(default=False, description="Whether the last point leads back to the first.")
    laps: Laps | None = Field(default=None, description=LAPS)

    @field_validator("laps")
    @classmethod
    def _only_if_closed(cls, laps: float | None, info: ValidationInfo) -> float | None:
        if laps is not None and info.data.get("closed") is False:
            refuse("an open path has no laps: give closed: true")
        return laps


class PolylineBlock(ClosablePathBlock):
    """Straight legs between points, their corners rounded by blends of continuous curvature rate."""

    type: Literal["polyline"]
    points_m: Waypoints = Field(description="Corners of the path, world axes [m]; two or more, three if closed.")
    corner_radius_m: Extent = Field(description=CORNER)

    @model_validator(mode="after")
    def _fits(self) -> PolylineBlock:
        from cube_sim.guidance.corner import round_corners
        from cube_sim.guidance.waypoints import as_waypoints

        points = accept(lambda: as_waypoints(self.points_m, self.closed), "points_m")
        accept(lambda: round_corners(points, self.corner_radius_m, self.closed), "points_m")
        return self


class SplineBlock(ClosablePathBlock):
    """A smooth curve through points: cubic, of continuous curvature."""

    type: Literal["spline"]
    points_m: Waypoints = Field(description="Points of the path, world axes [m]; two or more, three if closed.")

    @model_validator(mode="after")
    def _distinct(self) -> SplineBlock:
        from cube_sim.guidance.corner import require_no_reversal
        from cube_sim.guidance.waypoints import as_waypoints

        points = accept(lambda: as_waypoints(self.points_m, self.closed), "points_m")
        accept(lambda: require_no_reversal(points, self.closed), "points_m")
        return self


class CsvBlock(ClosablePathBlock):
    """Points from a CSV file whose first row names its columns, x_m, y_m and z_m among them."""

    type: Literal["csv"]
    file: TableFile = Field(description="CSV file, relative to the scenario file.")
    shape: Literal["spline", "polyline"] = Field(default="spline", description="What joins the points.")
    corner_radius_m: Extent | None = Field(default=None, description=CORNER + " Only, and always, for a polyline.")

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> CsvBlock:
        from cube_sim.guidance.corner import require_no_reversal, round_corners
        from cube_sim.guidance.waypoints import as_waypoints
        from cube_sim.guidance.waypoints_csv import read_waypoints

        if (self.shape == "polyline") != (self.corner_radius_m is not None):
            refuse("a polyline needs corner_radius_m, a spline has no corners", "corner_radius_m")
        if "directory" not in (info.context or {}):  # files go by their names in a record, and are not looked at
            return self
        try:
            points, rows = read_waypoints(FilePath(self.file))
            checked = as_waypoints(points, self.closed, rows)
            require_no_reversal(checked, self.closed, rows)
            if self.corner_radius_m is not None:
                round_corners(checked, self.corner_radius_m, self.closed, rows)
        except PathError as error:
            refuse(str(error), "file")
        return self


class PythonPathBlock(PythonBlock):
    """A path of one's own; see docs/extending.md."""

    type: Literal["python"]
    laps: Laps | None = Field(default=None, description=LAPS)


NamedPath = (
    LineBlock
    | PointBlock
    | ArcBlock
    | CircleBlock
    | HelixBlock
    | SinusoidBlock
    | PolylineBlock
    | SplineBlock
    | CsvBlock
)
AnyPath = Annotated[NamedPath | PythonPathBlock, Field(discriminator="type")]
