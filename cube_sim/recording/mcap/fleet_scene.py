"""What other programs' viewers draw of several vehicles: for each the topics it has alone, below its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cube_sim.recording.among import VehicleAmong, channels_of, rows_of
from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.foxglove import frame_transform_layout
from cube_sim.recording.mcap.names import TRANSFORM_TOPIC
from cube_sim.recording.mcap.scene import DrawnTopic, SceneRows
from cube_sim.recording.mcap.schemas import FRAME_TRANSFORM, frame_transform_schema


class FleetSceneRows:
    """Rows for the topics that viewers draw, see `SceneRows`.

    Attributes:
        topics: those there are, in the order in which they are declared.
        not_drawn: a line for each topic that there is not though the record has what it would show.
    """

    def __init__(self, channels: Sequence[Channel], vehicles: Sequence[VehicleAmong]) -> None:
        self._scenes: dict[str, SceneRows] = {}
        for each in vehicles:
            own, target = channels_of(each.name, channels), f"{each.name}/target"
            self._scenes[each.name] = SceneRows(own, each.model, each.body, each.name, target)
        self.topics: list[DrawnTopic] = []
        for name, scene in self._scenes.items():
            self.topics += [replace(drawn, topic=_below(name, drawn.topic)) for drawn in scene.topics]
            layout, seconds = frame_transform_layout(name)
            schema = frame_transform_schema()
            self.topics.append(DrawnTopic(_below(name, TRANSFORM_TOPIC), FRAME_TRANSFORM, schema, layout, seconds))
        self.not_drawn = tuple(f"{name}: {each}" for name, scene in self._scenes.items() for each in scene.not_drawn)

    def of(self, batch: Batch) -> Mapping[str, Rows]:
        """Rows of the topics that have any in this batch, by topic; column 0 is the time."""
        found: dict[str, Rows] = {}
        for name, scene in self._scenes.items():
            own = Batch(rows_of(name, batch.rows))
            found |= {_below(name, topic): rows for topic, rows in scene.of(own).items()}
            if "pose" in own.rows:
                found[_below(name, TRANSFORM_TOPIC)] = own.rows["pose"]
        return found


def _below(name: str, topic: str) -> str:
    return f"/{name}{topic}"
