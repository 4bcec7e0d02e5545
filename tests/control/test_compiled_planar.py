"""The compiled planar law is the readable one: run by the interpreter, its source gives the same numbers."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from support.places import SCENARIOS
from support.plain_callbacks import plain

from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.following import FOLLOWED
from cube_sim.control.planar import steering
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion

DT = 0.02
SETTINGS = {
    "estimated current": ("infante_circle_current", {}),
    "known current": (
        "infante_line_current",
        {"control.disturbance_time_s": None, "control.current_time_s": None, "knowledge.current_m_s": [0.3, 0.2, 0.0]},
    ),
    "disturbance alone": ("infante_sinusoid", {"control.current_time_s": None}),
    "slowed in curves": ("infante_spline", {"guidance.speed_m_s": 4.0}),
    "target held back": ("infante_circle", {"guidance.target_speed_limit_m_s": 1.6}),
    "waiting for nothing": ("infante_sinusoid", {"guidance.wait_for_thrusters": False, "guidance.speed_m_s": 3.0}),
}


def seen(parts: Any) -> Any:
    """Parts, and parts of parts, whose records' fields are attributes for the interpreter."""
    if isinstance(parts, np.ndarray):
        return parts.view(np.recarray) if parts.dtype.names else parts
    return type(parts)(*map(seen, parts)) if hasattr(parts, "_fields") else tuple(map(seen, parts))


def numbers(parts):
    """All arrays in parts, and parts of parts."""
    return [parts] if isinstance(parts, np.ndarray) else [array for part in parts for array in numbers(part)]


def assert_close(fast, slow):
    for a, b in zip(numbers(fast), numbers(slow), strict=True):
        for name in a.dtype.names or ():
            scale = max(1.0, np.abs(np.asarray(b[name], np.float64)).max(initial=0.0, where=np.isfinite(b[name])))
            np.testing.assert_allclose(a[name], b[name], rtol=1e-9, atol=1e-9 * scale, err_msg=name)


@pytest.mark.parametrize("name", SETTINGS)
@pytest.mark.parametrize("follows", [True, False])
def test_all_of_a_tick(name, follows):
    scenario, settings = SETTINGS[name]
    follower = prepare(load(SCENARIOS / f"{scenario}.yaml", settings)).controller
    assert isinstance(follower, PlanarFollower)
    follower.parts.settings["follows"] = follows
    rng = np.random.default_rng(7)
    fast, desired, followed = deepcopy(follower.parts), np.zeros(1, DESIRED), np.zeros(1, FOLLOWED)
    slow = seen(deepcopy((fast, desired, followed)))
    interpreted = plain(steering.__name__).steer
    assert not hasattr(interpreted, "py_func")
    point = follower.target.path.at(0.0)
    psi, position = np.arctan2(point.rotation[1, 0], point.rotation[0, 0]) + rng.normal(), point.position.copy()
    v, w, force, before = np.array([0.3, 0.0, 0.0]), np.zeros(3), np.zeros(6), deepcopy(follower.parts)
    for k in range(60):
        v += [0.05, *(0.02 * rng.normal(size=2))]
        w[2] += 0.01 * rng.normal()
        psi += DT * 10.0 * w[2]
        R = rotation_from_quaternion(quaternion_from_euler(0.0, 0.0, psi))
        position += 10.0 * DT * (R @ v) * [1.0, 1.0, 0.0]
        view = follower.target.seen(position, R @ v)
        if k == 50:
            view["remaining"] = 0.0
        follower.target.advance(float(view["speed"][0]), 10.0 * DT)
        force[[0, 1, 5]] = [200.0, 0.0, 50.0] * rng.normal(size=3)
        steering.steer(fast, view, desired, followed, R, v, w, force, DT)
        interpreted(slow[0], seen(view), *slow[1:], R, v, w, force, DT)
        assert_close((fast, desired, followed), slow)
        assert bool(followed["wrench"].any()) == follows
    assert (fast.observer.filtered.tobytes() != before.observer.filtered.tobytes()) == (
        name not in ("known current", "disturbance alone")
    )
    assert (fast.short.tobytes() != before.short.tobytes()) == (name != "waiting for nothing")
