"""What an MJCF says of fins that is most likely a mistake: another unit, or a site that is turned round."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import mujoco
import numpy as np

from cube_sim.vehicle.mjcf.fins import FinParameters

LARGEST = 5.0
"""Area of a fin, in V^(2/3) of its hull, beyond which it is worth a word: wings of gliders have one (a choice)."""
FLATTEST = 1.0
"""Lift slope [1/rad] below which it is: that of a wing of aspect ratio 0.65, or 0.06 per degree (a choice)."""
FASTEST_RAD_S = 10.0
"""Rate of a servo beyond which it is: 570 deg/s (a choice)."""
ALONG = 0.7
"""Cosine of the angle between a chord and the hull's x axis, either way, below which it is (a choice)."""


def unlikely_fin_words(spec: mujoco.MjSpec, fins: Sequence[FinParameters], volumes: Mapping[str, float]) -> list[str]:
    """Sentences on the numbers of fins that are most likely not meant.

    Args:
        spec: of the model.
        fins: as `cube_sim.vehicle.mjcf.fins.read_fins` returns them.
        volumes: body -> V of each hull [m^3].
    """
    return [f"fin '{fin.site}' {word}" for fin in fins for word in _of_one(spec, fin, volumes[fin.hull])]


def _of_one(spec: mujoco.MjSpec, fin: FinParameters, volume: float) -> Iterator[str]:
    face = volume ** (2.0 / 3.0)
    if fin.area > LARGEST * face:
        yield f"has an area of {fin.area:.3g} m^2, on a hull of {volume:.2g} m^3; is it in [m^2]?"
    if fin.lift_slope < FLATTEST and not len(fin.products):
        yield f"has a lift slope of {fin.lift_slope:.2g} per radian; thin fins have 2 to 6; is it in [1/rad]?"
    if fin.servo is not None and (rate := float(spec.actuators[fin.servo].dynprm[1])) > FASTEST_RAD_S:
        yield f"turns by {rate:.3g} rad/s; is the rate in [rad/s]?"
    ahead = _chord_along_x(spec, fin.site)
    if abs(ahead) < ALONG:
        yield "has its chord across the hull's x axis: flow from ahead does not meet its edge; the site's x axis is it"
    elif ahead < 0.0:
        yield "has its chord pointing astern, and meets flow from ahead with its trailing edge; the site's x axis is it"


def _chord_along_x(spec: mujoco.MjSpec, name: str) -> float:
    """Cosine of the angle between a fin's chord and the x axis of its hull."""
    site, how, axes = spec.site(name), spec.compiler, np.zeros(9)
    turned = np.array(site.quat, dtype=float)
    if site.alt.type != mujoco.mjtOrientation.mjORIENTATION_QUAT:
        turned = np.array(mujoco.MjSpec.resolve_orientation(bool(how.degree), how.eulerseq, site.alt))
    mujoco.mju_quat2Mat(axes, turned / np.linalg.norm(turned))
    return float(axes[0])
