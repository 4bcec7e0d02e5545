"""What moves on a hull in the Rerun view: an entity for each body below what carries it, with its own shapes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import mujoco
import numpy as np
import rerun as rr

from cube_sim.recording.batch import Rows
from cube_sim.recording.carried_bodies import carried_bodies, positions_at_rest
from cube_sim.recording.geometry import body_shapes, vehicle_body
from cube_sim.recording.rerun.parts import Parts
from cube_sim.recording.rerun.places import Places
from cube_sim.recording.rerun.scene import log_shape


class CarriedDrawing:
    """Draws the bodies that move on one vehicle.

    Args:
        recording: into which.
        model: the compiled model.
        vehicle: the body that swims; None for the first that can.
        places: where.
        parts: what is left out where it cannot be drawn.
        recorded: whether the run has recorded the positions of their joints; else they stay in their reference pose.
    """

    def __init__(
        self,
        recording: rr.RecordingStream,
        model: mujoco.MjModel,
        vehicle: str | None,
        places: Places,
        parts: Parts,
        recorded: bool,
    ) -> None:
        self._bodies, self._rest = carried_bodies(model, vehicle), positions_at_rest(model, vehicle)
        entities = {vehicle_body(model, vehicle): places.vehicle}
        fill = rr.components.FillMode.TransparentFillMajorWireframe
        for each in self._bodies:
            entity = f"{entities[each.parent]}/carried/{rr.escape_entity_path_part(each.name)}"
            entities[each.body] = entity
            for shape in body_shapes(model, each.body):
                parts.draw(shape.name, partial(log_shape, recording, f"{entity}/body", model, shape, fill))
        self._entities = entities
        if self._bodies and not recorded:
            for each in self._bodies:
                p, q = each.pose(self._rest)
                pose = rr.Transform3D(translation=p[0], quaternion=rr.Quaternion(xyzw=q[0, [1, 2, 3, 0]]))
                recording.log(entities[each.body], pose, static=True)
            names = ", ".join(each.name for each in self._bodies)
            said = rr.TextLog(f"{names}: how they stand is not recorded, drawn in the reference pose", level="WARN")
            recording.log(f"{places.log}/model/carried bodies", said, static=True)

    def placed(self, positions: Rows) -> Iterator[tuple[str, rr.ComponentColumnList]]:
        """The entity of each body, and how it stands on what carries it.

        Args:
            positions: (n, w) of all joints.

        Raises:
            ValueError: the model has others.
        """
        there = self._rest.shape[1]
        if positions.shape[1] != there:
            raise ValueError(f"the record has {positions.shape[1]} positions of joints, the model has {there}")
        for each in self._bodies:
            p, q = each.pose(positions)
            xyzw = np.ascontiguousarray(q[:, [1, 2, 3, 0]])
            yield self._entities[each.body], rr.Transform3D.columns(translation=p, quaternion=xyzw)
