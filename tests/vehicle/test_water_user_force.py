"""A user's own force: one Python function, compiled when it can be."""

from __future__ import annotations

import json
import math
import os

import mujoco
import numpy as np
import pytest
from mujoco import rollout
from support.edited_cube import edited_text
from support.flights import FORCES_ONLY
from support.places import HELIX, MODELS
from support.processes import printed_by
from support.water_bodies import DENSITY, Body, flown, get_state, random_body, reference, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.plugin import layout, packing, user_forces
from cube_sim.vehicle.plugin.warnings import collect_warnings

STIFFNESS = 30.0


def spring(time, position, rotation, velocity, through_water):
    """A spring to the world's origin, tied at the body's; plain arithmetic on arrays."""
    f = rotation.T @ (-STIFFNESS * position)
    return f[0], f[1], f[2], 0.0, 0.0, 0.0


def awkward_spring(time, position, rotation, velocity, through_water):
    """The same, in a way numba cannot compile."""
    named = {"x": position[0], "y": position[1], "z": position[2], "rank": lambda: 1}
    f = rotation.T @ np.array([-STIFFNESS * named[k] for k in "xyz"])
    return [*f, *np.zeros(3 * named["rank"]())]


def swell(time, position, rotation, velocity, through_water):
    return 5.0 * math.sin(2.0 * time), 0.0, 0.0, 0.0, 0.0, 0.1 * math.cos(time)


def floating() -> Body:
    return Body(mass=10.0, volume=10.0 / DENSITY, added=np.diag([15.0] * 3 + [0.5] * 3), inertia_at_cg=np.eye(3))


@pytest.mark.flight
@pytest.mark.parametrize(("function", "compiled"), [(spring, True), (awkward_spring, False)])
def test_mass_on_a_spring(function, compiled):
    """(m + a) x'' = -k x in any attitude: x(t) = x0 cos(sqrt(k / (m + a)) t)."""
    model = cube_sim.load_model(floating().spec(timestep=0.01), forces={"hull": function})
    assert user_forces.is_compiled(function) is compiled
    q = np.array([0.5, -0.5, 0.5, 0.5])
    start = np.concatenate([[0.3, -0.2, 0.1], q, np.zeros(6)])
    end = flown(model, start, 4.0)
    np.testing.assert_allclose(end[:3], start[:3] * np.cos(np.sqrt(STIFFNESS / 25.0) * 4.0), atol=1e-7)


@pytest.mark.flight
def test_it_is_a_force_in_body_axes_at_the_right_time():
    rng = np.random.default_rng(0)
    body, start = random_body(rng), tumbling(rng)
    model = cube_sim.load_model(body.spec(timestep=0.005), forces={"hull": swell})
    import scipy.integrate
    from support.water_bodies import fossen

    solution = scipy.integrate.solve_ivp(
        lambda t, y: fossen(body, y, np.array(swell(t, None, None, None, None))),
        (0.0, 1.5),
        start,
        method="DOP853",
        rtol=1e-11,
        atol=1e-12,
    )
    np.testing.assert_allclose(flown(model, start, 1.5), solution.y[:, -1], atol=1e-6)
    assert np.abs(solution.y[:3, -1] - reference(body, start, 1.5)[:3]).max() > 0.05


def test_velocity_arrives_in_body_axes():
    seen = []

    def spy(time, position, rotation, velocity, through_water):
        seen.append((time, position, rotation, velocity, through_water))
        return np.zeros(6)

    rng = np.random.default_rng(1)
    current = np.array([0.3, -0.2, 0.1])
    model = cube_sim.load_model(floating().spec("Euler"), forces={"hull": spy})
    model.opt.wind[:] = current
    data = mujoco.MjData(model)
    set_state(data, tumbling(rng))
    data.time = 3.5
    mujoco.mj_forward(model, data)
    time, position, rotation, velocity, through_water = seen[-1]
    assert time == 3.5
    np.testing.assert_allclose(position, data.qpos[:3])
    np.testing.assert_allclose(rotation, data.xmat[1].reshape(3, 3))
    np.testing.assert_allclose(velocity, get_state(data)[7:])
    np.testing.assert_allclose(velocity[:3] - through_water[:3], rotation.T @ current, atol=1e-14)
    np.testing.assert_allclose(velocity[3:], through_water[3:])


def test_named_in_the_model_file():
    text = f'<custom><text name="hull:force" data="{__name__}:spring"/></custom>'
    model = floating().model(timestep=0.01, extra=text)
    end = flown(model, np.array([0.4, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), 2.0)
    assert end[0] == pytest.approx(0.4 * np.cos(np.sqrt(STIFFNESS / 25.0) * 2.0), abs=1e-7)


def fails_late(time, position, rotation, velocity, through_water):
    return 1.0 / (time - time) if time > 0.2 else 1.0, 0.0, 0.0, 0.0, 0.0, 0.0


def raises_late(time, position, rotation, velocity, through_water):
    if time > 0.2:
        raise ValueError("the tether is torn")
    return 1.0, 0, 0, 0, 0, 0


def reads_past_the_end_late(time, position, rotation, velocity, through_water):
    return velocity[int(time / 0.2) * 1000], 0.0, 0.0, 0.0, 0.0, 0.0


def awkward_failure(time, position, rotation, velocity, through_water):
    wrench = {"x": 1.0 / (time - time) if time > 0.2 else 1.0, "rank": lambda: 1}
    return wrench["x"], *np.zeros(5 * wrench["rank"]())


FAILURES = [(fails_late, True), (raises_late, True), (reads_past_the_end_late, True), (awkward_failure, False)]


@pytest.mark.flight
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(("function", "compiled"), FAILURES)
def test_a_force_that_fails_is_not_a_number_compiled_or_not(function, compiled):
    model = cube_sim.load_model(floating().spec(timestep=0.01), forces={"hull": function})
    assert user_forces.is_compiled(function) is compiled
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    with collect_warnings() as warnings:
        mujoco.mj_step(model, data, nstep=20)
        assert not warnings
        assert np.all(np.isfinite(data.qpos))
        mujoco.mj_step(model, data, nstep=2)
        mujoco.mj_forward(model, data)
    assert np.isnan(data.qacc).all()
    assert "Nan, Inf or huge value in Q" in warnings[0]
    assert "Time = 0.2" in warnings[0]


@pytest.mark.flight
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("function", [raises_late, awkward_failure], ids=["compiled", "python"])
def test_a_scenario_whose_force_fails_ends_as_error(function, tmp_path):
    text = f'<text name="hull:force" data="{__name__}:{function.__name__}"/></custom>'
    (tmp_path / "model.xml").write_text(edited_text(("</custom>", text)))
    changes = {"model": str(tmp_path / "model.xml"), "duration_s": 1.0, "checks": FORCES_ONLY}
    result = cube_sim.run(HELIX, changes, tmp_path / "out")
    assert result.verdict == "ERROR"
    assert result.signals["pose.position"][-1, 0] == pytest.approx(0.2, abs=0.021)


@pytest.mark.flight
def test_what_a_compiled_force_takes_from_outside_is_that_of_its_load():
    """A model keeps what it was loaded with; one loaded after a change has the change."""
    anchor = np.array([0.0, 0.0, -5.0])

    def to_anchor(time, position, rotation, velocity, through_water):
        return anchor[0] - position[0], 0.0, 0.0, 0.0, 0.0, 0.0

    def pull() -> tuple[mujoco.MjModel, float]:
        model = cube_sim.load_model(floating().spec(), forces={"hull": to_anchor})
        return model, push(model)

    def place(model: mujoco.MjModel) -> float:
        return packing.packed_parameters(model)[layout.HEADER_SIZE + layout.FORCE]

    def push(model: mujoco.MjModel) -> float:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return float(data.qfrc_passive[0])

    first, before = pull()
    anchor[:] = 50.0, 0.0, 0.0
    _, after = pull()
    assert user_forces.is_compiled(to_anchor)
    assert (before, after, push(first)) == (0.0, 50.0, 0.0)
    assert place(pull()[0]) == place(pull()[0]) != place(first)


@pytest.mark.flight
def test_the_water_and_what_else_acts_start_without_the_compiler_the_second_time(tmp_path):
    """To the same bits. The water and INFANTE's lift come from disk.

    With a force that leans on numba's linear algebra, numba is loaded, not run.
    """
    program = """
import json, sys
import mujoco, numpy as np, cube_sim
from cube_sim.vehicle.plugin import user_force_code
if sys.argv[3] == "second":
    user_force_code._compile = None
def tether(time, position, rotation, velocity, through_water):
    force = rotation.T @ (np.array([1.0, 2.0, -5.0]) - position)
    return force[0], force[1], force[2], 0.0, 0.0, 0.0
forces = {"hull": tether} if sys.argv[2] == "tether" else {}
model = cube_sim.load_model(sys.argv[1], forces=forces)
data = mujoco.MjData(model)
data.ctrl[:] = np.linspace(-0.5, 1.0, model.nu)
data.qvel[:] = [1.0, 0.2, 0.0, 0.0, 0.0, 0.1]
mujoco.mj_step(model, data, nstep=20)
loaded = [name in sys.modules for name in ("numba", "cube_sim.vehicle.plugin.callbacks")]
print(json.dumps([data.qpos.tobytes().hex(), *loaded]))
"""
    found = {}
    for kind, model in (("water", "cube"), ("lift", "infante"), ("tether", "infante")):
        runs = []
        for start in ("first", "second"):
            environment = {**os.environ, "CUBE_SIM_CACHE_DIR": str(tmp_path)}
            printed = printed_by(program, MODELS / f"{model}.xml", kind, start, environment=environment)
            runs.append(json.loads(printed))
        assert runs[0][0] == runs[1][0]
        found[kind] = [compiling for _, *compiling in runs]
    assert found["water"] == [[True, True], [False, False]]
    assert found["lift"][1] == [False, False]
    assert found["tether"][1][0]
    assert sorted(path.name.partition(".")[2] for path in tmp_path.glob("user_force-*")) == ["numba.o", "o"]


def test_compiled_forces_run_on_threads():
    model = cube_sim.load_model(floating().spec(), forces={"hull": spring})
    data = mujoco.MjData(model)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    initial = np.zeros((4, mujoco.mj_stateSize(model, full)))
    for k in range(4):
        set_state(data, tumbling(np.random.default_rng(k)))
        mujoco.mj_getState(model, data, initial[k], full)
    once, _ = rollout.rollout(model, [data], initial, nstep=50)
    twice, _ = rollout.rollout(model, [mujoco.MjData(model), mujoco.MjData(model)], initial, nstep=50)
    assert np.array_equal(once, twice)


def test_the_model_in_another_process_says_that_the_function_is_missing(tmp_path):
    """A saved model carries no code: there its force is not a number, never silently nothing."""
    model = cube_sim.load_model(floating().spec(), forces={"hull": spring})
    packing.packed_parameters(model)[layout.PROCESS] = 0.123
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.isnan(data.qacc).all()


@pytest.mark.parametrize(
    ("forces", "reason"),
    [
        ({"ship": spring}, "no hull 'ship'; the model has hull"),
        ({"hull": lambda t, p, R, v, u: (1.0, 2.0)}, "returns shape (2,); six values are right"),
        ({"hull": lambda t, p, R, v, u: (np.nan, *np.zeros(5))}, "returns nan 0 0 0 0 0 for the hull at rest where it"),
        ({"hull": lambda t, p: p}, "fails for the hull at rest where it starts: TypeError"),
    ],
)
def test_wrong_functions_are_refused(forces, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(floating().spec(), forces=forces)
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ("spring", "write package.module:function"),
        ("no_such_module:f", "cannot be found"),
        ("math:tether", "cannot be found"),
    ],
)
def test_wrong_names_are_refused(data, reason):
    with pytest.raises(ModelError, match=reason):
        floating().model(extra=f'<custom><text name="hull:force" data="{data}"/></custom>')
