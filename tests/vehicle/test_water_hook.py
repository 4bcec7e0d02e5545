"""The hook as a guest in MuJoCo: it serves its own models, in every way MuJoCo runs them, and no others."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from mujoco import rollout
from support.places import CUBE, MODELS
from support.processes import printed_by
from support.water_bodies import DENSITY, Body, get_state, random_body, reference, scene, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.plugin import hook

DRY = """<mujoco><option integrator="RK4"/><custom><numeric name="own" data="20071734 1 4 118"/></custom><worldbody>
  <geom type="plane" size="5 5 1"/><body name="hull" pos="0 0 1"><freejoint/><geom size="0.1 0.2 0.3" type="box"/>
  <body><joint axis="0 1 0"/><geom size="0.05" pos="0.4 0 0"/></body></body></worldbody></mujoco>"""


def fall(model) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qvel[:] = np.linspace(-1.0, 1.0, model.nv)
    mujoco.mj_step(model, data, nstep=300)
    return np.concatenate([data.qpos, data.qvel])


def test_other_models_are_untouched_bit_for_bit():
    """The same program in a process without cube_sim and in this one, water installed."""
    program = (
        "import mujoco, numpy as np, sys\n"
        "m = mujoco.MjModel.from_xml_string(sys.argv[1]); d = mujoco.MjData(m)\n"
        "d.qvel[:] = np.linspace(-1.0, 1.0, m.nv); mujoco.mj_step(m, d, nstep=300)\n"
        "sys.stdout.write(np.concatenate([d.qpos, d.qvel]).tobytes().hex())"
    )
    alone = printed_by(program, DRY)
    cube_sim.load_model(CUBE)
    assert fall(mujoco.MjModel.from_xml_string(DRY)).tobytes().hex() == alone


def test_models_without_any_numeric_are_untouched():
    cube_sim.load_model(CUBE)
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=10)
    assert data.qvel[2] == pytest.approx(-9.81 * 10 * model.opt.timestep)


def test_two_water_models_at_once_do_not_mix():
    rng = np.random.default_rng(0)
    bodies = [random_body(rng, 2.0), random_body(rng, 4.0)]
    starts = [tumbling(rng), tumbling(rng)]
    models = [body.model() for body in bodies]
    datas = [mujoco.MjData(model) for model in models]
    for data, start in zip(datas, starts, strict=True):
        set_state(data, start)
    for _ in range(200):
        for model, data in zip(models, datas, strict=True):
            mujoco.mj_step(model, data)
    for body, start, data in zip(bodies, starts, datas, strict=True):
        np.testing.assert_allclose(get_state(data), reference(body, start, 1.0), atol=1e-6)


def test_several_vehicles_in_one_model():
    """Each moves as it does alone, and each is read back by its name."""
    rng = np.random.default_rng(1)
    current = (0.1, -0.2, 0.05)
    bodies = [replace(random_body(rng, ratio), current=current) for ratio in (0.5, 2.0, 4.0)]
    starts = [tumbling(rng) for _ in bodies]
    names = ["alpha", "beta", "gamma"]
    spec = mujoco.MjSpec.from_string(
        scene([(body, name, (0.0, 0.0, 0.0)) for body, name in zip(bodies, names, strict=True)], current=current)
    )
    model = cube_sim.load_model(spec)
    data = mujoco.MjData(model)
    for k, start in enumerate(starts):
        single = mujoco.MjData(bodies[k].model())
        set_state(single, start)
        data.qpos[7 * k : 7 * k + 7], data.qvel[6 * k : 6 * k + 6] = single.qpos, single.qvel
    mujoco.mj_step(model, data, nstep=200)
    for k, (body, start) in enumerate(zip(bodies, starts, strict=True)):
        alone = mujoco.MjData(body.model())
        set_state(alone, start)
        mujoco.mj_step(body.model(), alone, nstep=200)
        np.testing.assert_allclose(data.qpos[7 * k : 7 * k + 7], alone.qpos, atol=1e-10)
        vehicle = cube_sim.Vehicle.from_model(model, names[k])
        np.testing.assert_allclose(vehicle.added_mass, body.added)
        np.testing.assert_allclose(vehicle.mass_matrix, body.rigid, atol=1e-12)
        assert vehicle.displaced_mass == pytest.approx(DENSITY * body.volume)
    with pytest.raises(ModelError, match="name one of alpha, beta, gamma"):
        cube_sim.Vehicle.from_model(model)


def test_vehicles_attached_with_a_prefix():
    """Two files composed by MjSpec.attach: each hull keeps its own water, and there is one density."""
    fleet = mujoco.MjSpec()
    fleet.option.integrator, fleet.option.timestep = mujoco.mjtIntegrator.mjINT_RK4, 0.01
    for prefix, name in (("a/", "cube"), ("b/", "bluerov2_heavy")):
        child = mujoco.MjSpec.from_file(str(MODELS / f"{name}.xml"))
        child.option.integrator, child.option.timestep = fleet.option.integrator, fleet.option.timestep
        fleet.attach(child, frame=fleet.worldbody.add_frame(pos=[0.0, 3.0 * len(fleet.bodies), 0.0]), prefix=prefix)
    model = cube_sim.load_model(fleet)
    for name, file in (("a/hull", "cube.xml"), ("b/hull", "bluerov2_heavy.xml")):
        together = cube_sim.Vehicle.from_model(model, name)
        alone = cube_sim.Vehicle.from_model(cube_sim.load_model(MODELS / file))
        np.testing.assert_array_equal(together.added_mass, alone.added_mass)
        np.testing.assert_allclose(together.actuation_matrix, alone.actuation_matrix, atol=1e-15)
        assert together.thrusters.names == tuple(f"{name[:2]}T{i}" for i in range(1, 9))
    data = mujoco.MjData(model)
    data.ctrl[:8] = 0.5
    mujoco.mj_step(model, data, nstep=100)
    cube = cube_sim.load_model(CUBE)
    other = mujoco.MjData(cube)
    other.ctrl[:] = 0.5
    mujoco.mj_step(cube, other, nstep=100)
    np.testing.assert_allclose(data.qvel[:6], other.qvel, atol=1e-12)
    with pytest.raises(ModelError, match="there is only one water"):
        cube_sim.load_model(fleet, {"b/water:density": 1025.0})


def test_a_copy_and_a_saved_model_keep_their_water(tmp_path):
    rng = np.random.default_rng(2)
    body, start = random_body(rng), tumbling(rng)
    model = body.model()
    mujoco.mj_saveModel(model, str(tmp_path / "m.mjb"), None)
    for other in (copy.copy(model), mujoco.MjModel.from_binary_path(str(tmp_path / "m.mjb"))):
        a, b = mujoco.MjData(model), mujoco.MjData(other)
        for data in (a, b):
            set_state(data, start)
        mujoco.mj_step(model, a, nstep=100)
        mujoco.mj_step(other, b, nstep=100)
        assert np.array_equal(a.qpos, b.qpos)


def test_a_saved_model_in_another_process_needs_install(tmp_path):
    """As .mjb and as pickle: bit for bit as here after `cube_sim.install()`, and dry before it."""
    model, path = cube_sim.load_model(CUBE), tmp_path / "model"
    mujoco.mj_saveModel(model, str(path), None)
    path.with_suffix(".pickle").write_bytes(pickle.dumps(model))
    program = (
        "import mujoco, pickle, sys\npath = sys.argv[1]\n"
        "models = mujoco.MjModel.from_binary_path(path), pickle.load(open(path + '.pickle', 'rb'))\n"
        "def fly(m):\n d = mujoco.MjData(m)\n d.ctrl[:] = 0.5\n"
        " mujoco.mj_step(m, d, nstep=50)\n print(d.qpos.tobytes().hex())\n"
        "fly(models[0]), fly(models[1])\nimport cube_sim\ncube_sim.install()\nfly(models[0]), fly(models[1])"
    )
    *dry, wet, also_wet = (np.frombuffer(bytes.fromhex(text)) for text in printed_by(program, path).split())
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.5
    mujoco.mj_step(model, data, nstep=50)
    assert np.array_equal(wet, data.qpos)
    assert np.array_equal(also_wet, data.qpos)
    for pose in dry:
        assert pose[2] == pytest.approx(-0.5 * 9.81 * 0.5**2)  # after 0.5 s of free fall


def test_rollout_on_two_threads_is_the_loop_bit_for_bit():
    rng = np.random.default_rng(3)
    model = cube_sim.load_model(CUBE)
    initial, control = [], rng.uniform(-1.0, 1.0, (6, 80, model.nu))
    data = mujoco.MjData(model)
    for _ in range(6):
        mujoco.mj_resetData(model, data)
        set_state(data, tumbling(rng))
        state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        initial.append(state)
    states, _ = rollout.rollout(model, [mujoco.MjData(model), mujoco.MjData(model)], np.array(initial), control)
    for k in range(6):
        mujoco.mj_setState(model, data, initial[k], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        data.qacc_warmstart[:] = 0.0
        for row in control[k]:
            data.ctrl[:] = row
            mujoco.mj_step(model, data)
        state = np.zeros_like(initial[0])
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        assert np.array_equal(states[k, -1], state)


def test_batch_on_two_threads_is_the_loop_bit_for_bit():
    """And each simulation of a batch may have thrusters of its own condition."""
    from mujoco import batch

    from cube_sim.vehicle import faults
    from cube_sim.vehicle.plugin import layout, packing

    rng = np.random.default_rng(4)
    model = cube_sim.load_model(CUBE)
    fleet = batch.Batch(model, nsim=4, nthread=2)
    numbers = fleet.expand("numeric_data")
    models = []
    for k in range(4):
        own = copy.copy(model)
        faults.set_efficiency(own, "T1", k / 4)
        numbers[k] = own.numeric_data
        models.append(own)
    control = rng.uniform(-1.0, 1.0, (4, model.nu))
    fleet.ctrl[:] = control
    fleet.step(nstep=100)
    for k, own in enumerate(models):
        data = mujoco.MjData(own)
        data.ctrl[:] = control[k]
        mujoco.mj_step(own, data, nstep=100)
        assert np.array_equal(fleet.qpos[k], data.qpos)
    assert np.unique(np.array(fleet.qpos)[:, 0]).size == 4
    assert packing.packed_parameters(model)[0] == layout.MAGIC


def test_repeats_bitwise():
    rng = np.random.default_rng(5)
    body, start = random_body(rng), tumbling(rng)
    ends = []
    for _ in range(2):
        model = body.model()
        data = mujoco.MjData(model)
        set_state(data, start)
        mujoco.mj_step(model, data, nstep=500)
        ends.append(data.qpos.tobytes() + data.qvel.tobytes())
    assert ends[0] == ends[1]


def test_a_foreign_callback_is_not_thrown_out():
    previous = mujoco.get_mjcb_passive()
    mujoco.set_mjcb_passive(lambda m, d: None)
    try:
        with pytest.raises(ModelError, match="mjcb_passive: is already taken"):
            cube_sim.load_model(CUBE)
    finally:
        mujoco.set_mjcb_passive(None)
        hook.install()
    assert previous is None or mujoco.get_mjcb_passive() is not None


def momentum(model, data, body: Body) -> np.ndarray:
    nu, R = get_state(data)[7:], data.xmat[1].reshape(3, 3)
    return R @ ((body.rigid + body.added)[:3] @ nu)


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_contact_changes_the_impulse_by_what_the_wall_gave(cone):
    """Flying into a wall without drag: the change of (M_RB + M_A) nu is the impulse of the contact force."""
    body = Body(mass=10.0, volume=0.01, added=np.diag([30.0, 20.0, 25.0, 0.3, 0.4, 0.5]), inertia_at_cg=0.5 * np.eye(3))
    model = body.model(
        "Euler",
        0.0005,
        inside='<geom type="box" size="0.2 0.15 0.1" mass="0"/>',
        extra=f'<option cone="{cone}"/>'
        '<worldbody><geom type="plane" pos="1 0 0" zaxis="-1 0 0" size="9 9 1"/></worldbody>',
    )
    data = mujoco.MjData(model)
    set_state(data, np.array([0.6, 0, 0, 1, 0, 0, 0, 0.8, 0.0, 0.0, 0, 0, 0], dtype=float))
    mujoco.mj_forward(model, data)
    before, impulse = momentum(model, data, body), 0.0
    for _ in range(2000):
        mujoco.mj_step(model, data)
        impulse += data.qfrc_constraint[0] * model.opt.timestep
    mujoco.mj_forward(model, data)
    change = momentum(model, data, body) - before
    assert impulse < -10.0
    assert change[0] / impulse == pytest.approx(1.0, abs=1e-9)


def test_inverse_weights_are_those_of_the_whole_inertia():
    """An isotropic body: contact softness scales with 1/(m + a), not 1/m."""
    body = Body(mass=10.0, added=np.diag([30.0] * 3 + [0.5] * 3), inertia_at_cg=0.5 * np.eye(3))
    model = body.model()
    np.testing.assert_allclose(model.body_invweight0[1], [1 / 40.0, 1 / 1.0], rtol=1e-12)
    np.testing.assert_allclose(model.dof_invweight0, [1 / 40.0] * 3 + [1 / 1.0] * 3, rtol=1e-12)


def test_a_body_frame_off_its_centre_of_mass_stays_where_it_is():
    """MuJoCo may move a free body's frame to its centre of mass; the water's numbers are about the author's."""
    rng = np.random.default_rng(11)
    body, start = random_body(rng), tumbling(rng)
    spec = body.spec()
    spec.compiler.alignfree = True
    model = cube_sim.load_model(spec)
    np.testing.assert_allclose(model.body_ipos[1], body.cg)
    data = mujoco.MjData(model)
    set_state(data, start)
    mujoco.mj_step(model, data, nstep=200)
    np.testing.assert_allclose(get_state(data), reference(body, start, 1.0), atol=1e-6)


def test_a_hull_at_rest_does_not_fall_asleep():
    """Sleeping bodies are skipped by MuJoCo, but the current may pick up at any time."""
    body = Body(volume=0.01, linear=np.eye(6) * 5.0)
    model = body.model(extra='<option><flag sleep="enable"/></option>')
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=2000)
    model.opt.wind[:] = 0.3, 0.0, 0.0
    mujoco.mj_step(model, data, nstep=2000)
    assert data.qvel[0] > 0.2
