"""What a set of sensors can tell and what it cannot on a path flown in an attitude, in words."""

from __future__ import annotations

from collections.abc import Collection


def what_drifts(aids: Collection[str], nose_level: float | None = 1.0, moves_level: bool = True) -> str:
    """One sentence on what holds each part of the estimate.

    Args:
        aids: names of the sensors beside the inertial unit, of dvl, depth, heading and position; dvl or position is
            among them.
        nose_level: share of the path on which the nose is level enough for the compass to read; None when that shows
            in flight only.
        moves_level: whether the path goes anywhere but up and down: a turn about the vertical does not show in a
            vertical velocity.
    """
    if "position" in aids:
        level = "position is held by fixes"
        height = "" if "depth" in aids else ", depth too"
    else:
        level = "level position is dead-reckoned from the DVL and drifts"
        height = ", depth is held by its gauge" if "depth" in aids else ", and so does depth"
    return f"{level}{height}; {_heading(aids, nose_level, moves_level)}; roll and pitch are held by gravity"


def _heading(aids: Collection[str], nose_level: float | None, moves_level: bool) -> str:
    if not moves_level:
        without = "heading drifts with the gyro"
        without += "" if "position" in aids else ", and the level position with it"
    elif {"position", "dvl"} <= set(aids):
        without = "heading is seen while the vehicle moves, as the turn between DVL and fixes"
    elif "position" in aids:
        without = "heading is seen only while the vehicle accelerates sideways or ahead"
    else:
        without = "heading drifts with the gyro, and the level position with it"
    if "heading" not in aids:
        return without
    if nose_level == 1.0:
        return "heading is held by the compass"
    steep = "the nose points steeply up or down and the compass reads nothing"
    if nose_level is None:
        return f"heading is held by the compass, but where {steep}, {without}"
    if nose_level == 0.0:
        return f"{steep}: {without}"
    return f"heading is held by the compass on {nose_level:.0%} of the path; on the rest {steep}: {without}"
