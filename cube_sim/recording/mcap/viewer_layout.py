"""A layout for Foxglove and Lichtblick: without one their 3-D panel shows none of a recording's topics."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.foxglove import WORLD_FRAME
from cube_sim.recording.mcap.named_fields import Code, Group, Number, Part, identifier, parts_of
from cube_sim.recording.mcap.names import topic
from cube_sim.recording.mcap.scene import HULL_TOPIC, PATH_TOPIC, THRUST_TOPIC, TRAIL_TOPIC
from cube_sim.scenario.distance_block import DISTANCE
from cube_sim.scenario.fleet import of_vehicle

_PLOTS = (
    ("Path error", ("path_error.cross_track", "path_error.along")),
    ("Thruster forces", ("thrusters.force",)),
    ("Wrench demanded", ("wrench.demanded",)),
    ("Fin deflections", ("fins.deflection",)),
    ("Set-points", ("setpoints.reached",)),
)


def viewer_layout(channels: Sequence[Channel], vehicle: str, among: Sequence[str] = ()) -> str:
    """Lay out the scene beside plots, as JSON.

    Args:
        channels: the channel table.
        vehicle: name of the vehicle's frame.
        among: of several vehicles, their names.
    """
    panels: dict[str, Any] = {"3D!scene": _scene(among[0] if among else vehicle, among)}
    of_several = tuple(f"{c.name}.{field.name}" for c in channels if c.name == DISTANCE for field in c.fields)
    asked = [
        (f"{name}: {title}", tuple(of_vehicle(name, signal) for signal in signals))
        for name in among
        for title, signals in _PLOTS[:2]
    ]
    for title, signals in [("Distance between vehicles", of_several), *asked] if among else _PLOTS:
        paths = [path for signal in signals for path in _paths(channels, signal)]
        if paths:
            panels[f"Plot!{title.lower().replace(' ', '_')}"] = _plot(title, paths)
    plots = [name for name in panels if name.startswith("Plot!")]
    layout = "3D!scene" if not plots else _split("row", "3D!scene", _column(plots), 55)
    content = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": layout,
    }
    return json.dumps(content, indent=2) + "\n"


def _scene(vehicle: str, among: Sequence[str]) -> dict[str, Any]:
    topics = (HULL_TOPIC, PATH_TOPIC, TRAIL_TOPIC, THRUST_TOPIC)
    shown = {f"/{name}{topic}" if name else topic: {"visible": True} for name in among or ("",) for topic in topics}
    return {
        "followMode": "follow-position",
        "followTf": vehicle,
        "cameraState": {"distance": 9, "perspective": True, "phi": 60, "thetaOffset": 45, "target": [0, 0, 0]},
        "scene": {"backgroundColor": "#071a2c", "transforms": {"showLabel": False, "axisScale": 0.4}},
        "transforms": {f"frame:{WORLD_FRAME}": {"visible": True}},
        "topics": shown,
        "layers": {},
    }


def _plot(title: str, paths: Sequence[str]) -> dict[str, Any]:
    series = [
        {"value": path, "enabled": True, "timestampMethod": "receiveTime", "label": path.partition(".")[2]}
        for path in paths
    ]
    return {
        "foxglovePanelTitle": title,
        "paths": series,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "isSynced": True,
        "xAxisVal": "timestamp",
    }


def _paths(channels: Sequence[Channel], signal: str) -> Iterator[str]:
    """Where viewers find the numbers of a signal."""
    for channel in channels:
        for field, part in zip(channel.fields, parts_of(channel), strict=True):
            if f"{channel.name}.{field.name}" == signal:
                yield from (f"{topic(channel)}.{path}" for path in _numbers(part))


def _numbers(part: Part) -> Iterator[str]:
    name = identifier(part.name)
    if isinstance(part, Group) and not part.listed:
        yield from (f"{name}.{path}" for inner in part.elements[0] for path in _numbers(inner))
    elif isinstance(part, (Number, Code)):
        yield name


def _column(panels: Sequence[str]) -> Any:
    if len(panels) == 1:
        return panels[0]
    return _split("column", panels[0], _column(panels[1:]), round(100 / len(panels)))


def _split(direction: str, first: Any, second: Any, percentage: int) -> dict[str, Any]:
    return {"direction": direction, "first": first, "second": second, "splitPercentage": percentage}
