"""Fins whose numbers are most likely in another unit, and those that are turned round."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import mujoco
import numpy as np

from cube_sim.vehicle.mjcf.fins import FinParameters

LARGEST = 5.0
"""Area of a fin, in V^(2/3) of its vehicle, beyond which it is worth a word: wings of gliders have one (a choice)."""
FLATTEST = 1.0
"""Lift slope [1/rad] below which it is: that of a wing of aspect ratio 0.65, or 0.06 per degree (a choice)."""
FASTEST_RAD_S = 10.0
"""Rate of a servo beyond which it is: 570 deg/s (a choice)."""
ALONG = 0.7
"""Cosine of the angle between a chord and the hull's x axis, either way, below which it is (a choice)."""


def unlikely_fins(model: mujoco.MjModel, fins: Sequence[FinParameters], sizes: Mapping[str, float]) -> Iterator[str]:
    """Sentences on the numbers of fins.

    Args:
        model: made by `load_model`.
        fins: as `cube_sim.vehicle.mjcf.fins.read_fins` returns them.
        sizes: as `sizes_of` returns them.
    """
    for fin in fins:
        yield from (f"fin '{fin.site}' {word}" for word in _of_one(model, fin, sizes.get(fin.hull)))


def _of_one(model: mujoco.MjModel, fin: FinParameters, volume: float | None) -> Iterator[str]:
    if volume is not None and fin.area > LARGEST * volume ** (2.0 / 3.0):
        yield f"has an area of {fin.area:.3g} m^2, on a hull of {volume:.2g} m^3; is it in [m^2]?"
    if fin.lift_slope < FLATTEST and not len(fin.products):
        yield f"has a lift slope of {fin.lift_slope:.2g} per radian; thin fins have 2 to 6; is it in [1/rad]?"
    if fin.servo is not None and (rate := float(model.actuator_dynprm[fin.servo, 1])) > FASTEST_RAD_S:
        yield f"turns by {rate:.3g} rad/s; is the rate in [rad/s]?"
    ahead = _chord_along_x(model, fin.site)
    if abs(ahead) < ALONG:
        yield "has its chord across the hull's x axis: flow from ahead does not meet its edge; the site's x axis is it"
    elif ahead < 0.0:
        yield "has its chord pointing astern, and meets flow from ahead with its trailing edge; the site's x axis is it"


def _chord_along_x(model: mujoco.MjModel, site: str) -> float:
    """Cosine of the angle between a fin's chord and the x axis of its hull."""
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, model.site(site).quat)
    return float(axes[0])
