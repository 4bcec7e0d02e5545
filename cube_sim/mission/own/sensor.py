"""A sensor of the user's own: its factory asked, its readings looked at."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cube_sim.mission.own.code import Codes, OwnCode, made, numbers_of, refused
from cube_sim.mission.own.handed import handed
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.own_aid import OwnAid
from cube_sim.navigation.sampling import Sampling
from cube_sim.scenario import Loaded
from cube_sim.scenario.navigation_blocks import OwnSensorBlock
from cube_sim.spatial import Matrix, Vector


def own_sensors(loaded: Loaded, codes: Codes, motion: Motion) -> tuple[OwnAid, ...]:
    """The sensors of one's own that a scenario names, each asked once.

    Args:
        loaded: the scenario.
        codes: the code it names.
        motion: of the vehicle at the start.

    Raises:
        ScenarioError: the code makes none, or its reading is none; with position.
    """
    block, sensors = loaded.scenario.navigation, []
    for index, own in enumerate(block.own if block is not None else ()):
        code = codes[f"navigation.own.{index}"]
        with refused(loaded):
            if not callable(getattr(thing := made(loaded, code), "reading", thing)):
                raise code.refuse(f"makes a {type(thing).__name__}; it takes a function, or an object with reading")
            aid = _sensor(code, own, thing)
            if aid.reading(motion) is not None and aid.jacobian is not None:
                aid.jacobian(motion)
        sensors.append(aid)
    return tuple(sensors)


def _sensor(code: OwnCode, block: OwnSensorBlock, thing: Any) -> OwnAid:
    """The sensor around what a factory has made."""
    n, read = block.components, getattr(thing, "reading", thing)

    def reading(motion: Motion) -> Vector | None:
        answer = code.call(read, handed(motion))
        return None if answer is None else numbers_of(code, np.atleast_1d(answer), (n,), "a reading")

    return OwnAid(
        name=block.name,
        sampling=Sampling(block.rate_hz, block.delay_s),
        components=n,
        noise=block.noise,
        bias=block.bias,
        angle=block.angle,
        reading=reading,
        jacobian=_jacobian(code, n, getattr(thing, "jacobian", None)),
    )


def _jacobian(code: OwnCode, n: int, differentiate: Any) -> Callable[[Motion], Matrix] | None:
    if differentiate is None:
        return None
    return lambda motion: numbers_of(code, code.call(differentiate, handed(motion)), (n, 12), "a Jacobian")
