"""`phases`: legs of a mission, each with a path of its own, flown one after the other; and `waypoints`, for short."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import atan2, degrees, dist
from typing import Any, ClassVar, Literal, Self

from pydantic import Field, ValidationError, model_validator

from cube_sim.scenario.attitude_blocks import NamedAttitude
from cube_sim.scenario.document import Location
from cube_sim.scenario.guidance_block import GuidanceBlock
from cube_sim.scenario.path_blocks import NamedPath
from cube_sim.scenario.statistic_keys import SparingBlock
from cube_sim.scenario.values import Angle, Block, Extent, Place, Seconds, Speed, Title, refuse

REACH_M = 0.5
WITHIN_DEG = 5.0
_SHORTEST_M = 0.01
WhenLate = Literal["go_on", "fail"]
TIME_LIMIT: Any = Field(
    default=None,
    description="It is over after this time even where the vehicle has not arrived, which is late [s]. Default: none.",
)
WHEN_LATE: Any = Field(
    default="go_on", description="go_on: being late is a warning, and counts. fail: the run ends and has failed."
)


class PhaseBlock(SparingBlock):
    """A leg of the mission. It is over when the vehicle has arrived at the end of its path, or after a time."""

    sparing: ClassVar[frozenset[str]] = frozenset(("time_limit_s", "when_late"))

    name: Title = Field(description="Shown where the phase is told.")
    path: NamedPath = Field(discriminator="type", description="Its path, see `path`.")
    guidance: GuidanceBlock = Field(
        description="What is other than in the `guidance` at the top, which holds for all phases; see there."
    )
    attitude: NamedAttitude | None = Field(
        default=None, discriminator="mode", description="Its attitude, see there. Default: that of `control.attitude`."
    )
    reach_m: Extent = Field(default=REACH_M, description="Distance to the end of the path at which it has arrived [m].")
    within_deg: float | None = Field(
        default=None, gt=0, le=180, description="And the attitude's error, to have arrived [deg]. Default: any."
    )
    hold_s: float = Field(
        default=0.0, ge=0, le=86400, description="For how long it has to be there without a break [s]."
    )
    for_s: Seconds | None = Field(
        default=None, description="It is over after this time, arrived or not [s]. Default: when it has arrived."
    )
    time_limit_s: Seconds | None = TIME_LIMIT
    when_late: WhenLate = WHEN_LATE

    @model_validator(mode="after")
    def _one_end(self) -> Self:
        if self.for_s is not None and self.time_limit_s is not None:
            refuse("for_s ends the phase, arrived or not: leave out one of the two", "time_limit_s")
        _require_limit(self)
        return self


class WaypointBlock(Block):
    """A straight leg to a point from the one before, the first from where the vehicle starts."""

    to_m: Place = Field(description="Where to, world axes [m].")
    name: Title | None = Field(default=None, description="Shown where it is told. Default: its number.")
    speed_m_s: Speed | None = Field(default=None, description="On the way [m/s]. Default: guidance.speed_m_s.")
    hold_s: float = Field(default=0.0, ge=0, le=86400, description="How long the point is held then [s].")
    heading_deg: Angle | None = Field(
        default=None,
        description="Where to the vehicle turns there, from world x towards y [deg]. Default: it stays as it came.",
    )
    reach_m: Extent = Field(default=REACH_M, description="Distance at which it has arrived [m].")
    time_limit_s: Seconds | None = TIME_LIMIT
    when_late: WhenLate = WHEN_LATE

    @model_validator(mode="after")
    def _limited(self) -> Self:
        _require_limit(self)
        return self


def _require_limit(block: PhaseBlock | WaypointBlock) -> None:
    if block.when_late != "go_on" and block.time_limit_s is None:
        refuse("there is no time limit to be late for: give time_limit_s", "when_late")


def is_timed(phases: Iterable[PhaseBlock]) -> bool:
    """Whether any of some phases can run out of time."""
    return any(phase.time_limit_s is not None for phase in phases)


def with_first_leg(data: dict[str, Any]) -> dict[str, Any]:
    """Data of a scenario whose phases are written out: `path` and `guidance` are the first one's.

    What is wrong in them stays as it is, for the schema to refuse.
    """
    if _by_waypoints(data):
        phases = _legs(data)
        if phases is None:
            return data
        data = {**{key: value for key, value in data.items() if key != "waypoints"}, "phases": phases}
    phases, common = data.get("phases"), data.get("guidance")
    if not isinstance(phases, list | tuple) or not phases or not all(isinstance(phase, dict) for phase in phases):
        return data
    written = [_with_guidance(phase, common) for phase in phases]
    first = written[0]
    data = {**data, "phases": written}
    data.setdefault("path", first.get("path"))
    data["guidance"] = first.get("guidance")
    return data


def _by_waypoints(data: Mapping[str, Any]) -> bool:
    """Whether its phases are to be written out from waypoints; both are refused by the schema."""
    return data.get("waypoints") is not None and not data.get("phases")


def _with_guidance(phase: dict[str, Any], common: Any) -> dict[str, Any]:
    own = phase.get("guidance")
    if not isinstance(common, dict) or not isinstance(own, dict | None):
        return phase
    return {**phase, "guidance": {**common, **(own or {})}}


def _legs(data: Mapping[str, Any]) -> list[dict[str, Any]] | None:
    """The phases that waypoints stand for; None where they are not right."""
    waypoints, initial = data["waypoints"], data.get("initial")
    try:
        blocks = [WaypointBlock.model_validate(waypoint) for waypoint in waypoints]
        place = [float(x) for x in (initial or {}).get("position_m", (0.0, 0.0, 0.0))]
    except (ValidationError, TypeError, ValueError, AttributeError):
        return None
    phases: list[dict[str, Any]] = []
    heading = 0.0
    for i, block in enumerate(blocks):
        name = block.name or f"waypoint {i + 1}"
        to, stays = list(block.to_m), block.hold_s > 0.0 or block.heading_deg is not None
        guidance: dict[str, Any] = {} if block.speed_m_s is None else {"speed_m_s": block.speed_m_s}
        limit = {} if block.time_limit_s is None else {"time_limit_s": block.time_limit_s, "when_late": block.when_late}
        if dist(place, to) >= _SHORTEST_M:
            if to[:2] != place[:2]:
                heading = degrees(atan2(to[1] - place[1], to[0] - place[0]))
            path = {"type": "line", "start_m": place, "end_m": to}
            phases.append({"name": name, "path": path, "guidance": guidance, "reach_m": block.reach_m, **limit})
            limit = {}
        if stays or dist(place, to) < _SHORTEST_M:
            heading = heading if block.heading_deg is None else block.heading_deg
            path = {"type": "point", "position_m": to, "heading_deg": heading}
            held = {"name": f"{name}: hold", "path": path, "guidance": guidance, "reach_m": block.reach_m}
            if block.heading_deg is not None:
                held |= {"within_deg": WITHIN_DEG}
            phases.append({**held, "hold_s": block.hold_s, **limit})
        place = to
    return phases


def as_written(location: Location, data: Mapping[str, Any]) -> Location:
    """Where a value stands in a file that may have left it to be written out by `with_first_leg`."""
    if _by_waypoints(data) and location[:1] in (("phases",), ("path",)):
        return ("waypoints",)
    phases = data.get("phases")
    if not isinstance(phases, list | tuple) or not phases or len(location) == 0:
        return location

    def own(index: int) -> Mapping[str, Any]:
        given = phases[index].get("guidance") if isinstance(phases[index], dict) else None
        return given if isinstance(given, dict) else {}

    top, below = location[:1], location[1:2]
    of_the_first = top == ("guidance",) and bool(below) and below[0] in own(0)
    if of_the_first or (top in (("path",), ("guidance",)) and location[0] not in data):
        return ("phases", 0, *location)
    if len(location) > 3 and location[0] == "phases" and location[2] == "guidance" and "guidance" in data:
        return location if location[3] in own(int(location[1])) else location[2:]
    return location
