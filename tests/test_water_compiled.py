"""The same laws once: what runs inside MuJoCo equals the readable Python it was compiled from."""

from __future__ import annotations

from types import FunctionType

import numpy as np
import pytest
from water_bodies import DENSITY, GRAVITY, coriolis_matrix, random_body, tumbling

from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle import hydrodynamics, thrust_law


def uncompiled(module) -> dict:
    """The functions of a module as plain Python all the way down: also their calls to each other stay Python."""
    namespace = {"abs": abs, "len": len, "min": min, "max": max, "range": range}
    for name, value in vars(module).items():
        if hasattr(value, "py_func"):
            namespace[name] = FunctionType(value.py_func.__code__, namespace, name)
    return namespace


def tuples(*arrays):
    return [tuple(float(x) for x in array) for array in arrays]


@pytest.mark.parametrize("seed", range(10))
def test_water_wrench_is_the_uncompiled_law(seed):
    rng = np.random.default_rng(seed)
    body, state = random_body(rng, 3.0), tumbling(rng)
    R = rotation_from_quaternion(state[3:7])
    nu, current, buoyancy, cb = tuples(state[7:], body.current, [0.0, 0.0, DENSITY * body.volume * GRAVITY], body.cb)
    arguments = body.added, body.linear, body.quadratic, R, nu, current, buoyancy, cb
    plain = uncompiled(hydrodynamics)["water_wrench"](*arguments)
    fast = hydrodynamics.water_wrench(*arguments)
    assert all(isinstance(x, float) for x in plain)
    np.testing.assert_allclose(fast, plain, rtol=0.0, atol=1e-12 * np.abs(plain).max())


@pytest.mark.parametrize("seed", range(5))
def test_coriolis_is_fossens_matrix(seed):
    rng = np.random.default_rng(seed)
    body, nu = random_body(rng), rng.normal(size=6)
    expected = coriolis_matrix(body.added, nu) @ nu
    np.testing.assert_allclose(hydrodynamics.coriolis(body.added, tuple(nu)), expected, atol=1e-13)
    assert abs(np.dot(expected, nu)) < 1e-12  # it does no work


def test_interpolation_is_the_uncompiled_law_and_numpys():
    plain = uncompiled(thrust_law)["interpolate"]
    rng = np.random.default_rng(0)
    for n in (2, 3, 22):
        x, y = np.cumsum(rng.uniform(0.1, 1.0, n)), rng.normal(size=n)
        for at in [*rng.uniform(x[0] - 1.0, x[-1] + 1.0, 200), *x]:
            assert thrust_law.interpolate(at, x, y) == pytest.approx(plain(at, x, y), abs=1e-12)
            assert plain(at, x, y) == pytest.approx(np.interp(at, x, y), abs=1e-12)
