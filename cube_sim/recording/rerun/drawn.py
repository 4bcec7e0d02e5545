"""What is known of a run before it is drawn: where it is, how large things are, what its scenario says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.carried_bodies import whole_reach
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import vehicle_reach, vehicle_shapes
from cube_sim.recording.rerun.places import Places
from cube_sim.recording.rerun.scene import Look, Measures
from cube_sim.recording.rerun.story import Story


@dataclass(frozen=True)
class Drawn:
    """A run as its layout and its drawing see it.

    Attributes:
        places: where it is drawn.
        look: how it looks beside another.
        channels: the channel table.
        story: what the scenario says.
        points: (n, 3) what must be in sight, world axes [m]; n may be 0.
        boxes: Rerun paths of the boxes the vehicle is made of.
        measures: how large things are drawn.
        extent: how far the vehicle reaches with all that moves on it [m].
    """

    places: Places
    look: Look
    channels: Sequence[Channel]
    story: Story
    points: NDArray[np.float64]
    boxes: Sequence[str]
    measures: Measures
    extent: float


def drawn_from(
    channels: Sequence[Channel],
    model: mujoco.MjModel,
    vehicle: str | None,
    story: Story,
    first: Batch,
    places: Places = Places(),  # noqa: B008 - it is frozen
    look: Look = Look(),  # noqa: B008
) -> Drawn:
    """Gather what the first batch and the model say.

    Args:
        channels: the channel table.
        model: the compiled model.
        vehicle: the body that swims; None for the first that can.
        story: what the scenario says.
        first: the run's first batch: it alone knows the path and the thrusters' limits.
        places: where the run is drawn.
        look: how it looks beside another.
    """
    columns = {
        (channel.name, field.name): (first.rows[channel.name], place)
        for channel in channels
        if channel.name in first.rows
        for field, place in zip(channel.fields, channel.columns, strict=True)
    }

    def of(channel: str, field: str) -> Rows:
        rows, place = columns.get((channel, field), (np.empty((0, 1)), slice(0, 0)))
        return rows[:, place]

    points = np.vstack([of("path", "points")[:1].reshape(-1, 3), of("pose", "position")[:1].reshape(-1, 3)])
    limits = of("actuation", "limits")[:1]
    largest_N = float(np.abs(limits[np.isfinite(limits)]).max(initial=0.0))
    measures = Measures.of(vehicle_reach(model, vehicle), largest_N, _usual_force(of("thrusters", "force")))
    boxes = [
        f"{places.vehicle}/body/{shape.name}"
        for shape in vehicle_shapes(model, vehicle)
        if shape.kind == mujoco.mjtGeom.mjGEOM_BOX
    ]
    extent = max(measures.reach, whole_reach(model, vehicle))
    return Drawn(places, look, tuple(channels), story, points, boxes, measures, extent)


def _usual_force(forces: Rows) -> float:
    """What the hardest working thruster gives, all but a twentieth of the time [N]; 0 where nothing is known."""
    hardest = np.abs(forces).max(axis=1, initial=0.0)
    hardest = hardest[np.isfinite(hardest)]
    return float(np.quantile(hardest, 0.95)) if len(hardest) else 0.0
