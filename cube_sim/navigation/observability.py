"""What a set of sensors can tell and what it cannot, in words."""

from __future__ import annotations

from collections.abc import Collection


def what_drifts(aids: Collection[str]) -> str:
    """One sentence on what holds each part of the estimate.

    Args:
        aids: names of the sensors beside the inertial unit, of dvl, depth, heading and position; dvl or position is
            among them.
    """
    if "position" in aids:
        level = "position is held by fixes"
        height = "" if "depth" in aids else ", depth too"
    else:
        level = "level position is dead-reckoned from the DVL and drifts"
        height = ", depth is held by its gauge" if "depth" in aids else ", and so does depth"
    if "heading" in aids:
        heading = "heading is held by the compass"
    elif {"position", "dvl"} <= set(aids):
        heading = "heading is seen while the vehicle moves, as the turn between DVL and fixes"
    elif "position" in aids:
        heading = "heading is seen only while the vehicle accelerates sideways or ahead"
    else:
        heading = "heading drifts with the gyro, and the level position with it"
    return f"{level}{height}; {heading}; roll and pitch are held by gravity"
