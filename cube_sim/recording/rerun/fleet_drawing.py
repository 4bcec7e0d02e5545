"""Several vehicles of one run, each drawn as it is alone, in one scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr

from cube_sim.recording.among import VehicleAmong, batch_of, channels_of, checks_of
from cube_sim.recording.batch import Batch
from cube_sim.recording.channels import Channel
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.drawing import TIMELINE, RunDrawing
from cube_sim.recording.rerun.drawn import Drawn, drawn_from
from cube_sim.recording.rerun.side_by_side import looks_of_vehicles
from cube_sim.recording.rerun.story import Story
from cube_sim.recording.run_end import RunEnd
from cube_sim.scenario.distance_block import DISTANCE

_PLOT = "/plot/distance"
_COLOURS = (palette.ORANGE, palette.SKY, palette.GREEN, palette.PURPLE, palette.YELLOW, palette.VERMILION)


def vehicles_drawn(
    channels: Sequence[Channel], vehicles: Sequence[VehicleAmong], stories: Mapping[str, Story], first: Batch
) -> list[Drawn]:
    """What is known of each vehicle before it is drawn.

    Args:
        channels: the channel table of the run.
        vehicles: all of them.
        stories: what the scenario says of each, by name.
        first: the run's first batch.
    """
    names = [each.name for each in vehicles]
    seen = []
    around = []
    for each in vehicles:  # what stands around them is drawn once, of those from one file
        look = each.model.ngeom, each.model.geom_pos.tobytes(), each.model.geom_size.tobytes()
        around.append(look not in seen)
        seen.append(look)
    return [
        drawn_from(
            channels_of(each.name, channels),
            each.model,
            each.body,
            stories[each.name],
            batch_of(each.name, first, names),
            places,
            look,
        )
        for each, (places, look) in zip(vehicles, looks_of_vehicles(names, around), strict=True)
    ]


def distance_entities(channels: Sequence[Channel]) -> list[str]:
    """Where the distances between vehicles are plotted."""
    return [f"{_PLOT}/{field.name}" for channel in channels if channel.name == DISTANCE for field in channel.fields]


class FleetDrawing:
    """Draws several vehicles.

    Args:
        recording: into which.
        drawn: what is known of each.
        vehicles: all of them.
        channels: the channel table of the run.
    """

    def __init__(
        self,
        recording: rr.RecordingStream,
        drawn: Sequence[Drawn],
        vehicles: Sequence[VehicleAmong],
        channels: Sequence[Channel],
    ) -> None:
        self._recording, self._names = recording, [each.name for each in vehicles]
        self._drawings = {
            each.name: RunDrawing(recording, one, each.model, each.body)
            for each, one in zip(vehicles, drawn, strict=True)
        }
        self._distances = distance_entities(channels)
        for index, entity in enumerate(self._distances):
            name = entity.rpartition("/")[2].replace("_to_", " to ")
            style = rr.SeriesLines(names=[name], colors=[_COLOURS[index % len(_COLOURS)]], widths=[1.5])
            recording.log(entity, style, static=True)

    def write(self, batch: Batch) -> None:
        """Draw the next batch."""
        for name, drawing in self._drawings.items():
            drawing.write(batch_of(name, batch, self._names))
        rows = batch.rows.get(DISTANCE)
        if rows is not None:
            times = rr.TimeColumn(TIMELINE, duration=np.rint(rows[:, 0] * 1e9).astype("timedelta64[ns]"))
            for index, entity in enumerate(self._distances):
                values = rr.Scalars.columns(scalars=np.ascontiguousarray(rows[:, 1 + index]))
                self._recording.send_columns(entity, [times], values)

    def tell(self, end: RunEnd) -> None:
        """Show how the run ended, at each vehicle with its own checks and those of several."""
        of_all = [check for check in end.checks if not check.name.startswith(tuple(f"{n}: " for n in self._names))]
        for name, drawing in self._drawings.items():
            checks = (*checks_of(name, end.checks), *of_all)
            drawing.tell(RunEnd(**{**vars(end), "checks": checks}))
