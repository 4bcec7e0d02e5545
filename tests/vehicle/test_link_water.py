"""Water on the links of an arm, against equations written a second time and against laws of mechanics."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support import plain_callbacks
from support.linked import Link, Linked, inward, random_link, random_start
from support.water_bodies import Body, random_body

import cube_sim
from cube_sim.spatial import skew

ARMS = {
    "two hinges": (("hinge", "hinge"), (0, 1)),
    "hinge, slide, and another on the hull": (("hinge", "slide", "hinge"), (0, 1, 0)),
    "a part fixed on a link": (("hinge", "none", "hinge"), (0, 1, 1)),
}


def arm_of(rng, kinds, parents, damped: bool = True) -> Linked:
    hull = random_body(rng, 1.5)
    links = (random_link(rng, parent, kind, damped) for kind, parent in zip(kinds, parents, strict=True))
    return Linked(
        hull if damped else hull.ideal(), tuple(replace(link, stiffness=6.0, friction=0.02 * damped) for link in links)
    )


def apart(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest difference of two states; a quaternion and its negative are one attitude."""
    found = found.copy()
    found[3:7] *= np.sign(found[3:7] @ expected[3:7])
    return float(np.abs(found - expected).max())


@pytest.mark.parametrize("arm", ARMS)
def test_accelerations_are_those_of_the_second_equations(arm):
    for seed in range(5):
        rng = np.random.default_rng(seed)
        linked = arm_of(rng, *ARMS[arm])
        model, start = linked.model(), random_start(rng, len(linked.moving))
        data = mujoco.MjData(model)
        linked.set_state(data, start)
        mujoco.mj_forward(model, data)
        R = data.xmat[1].reshape(3, 3)
        found = np.concatenate(
            [R.T @ data.qacc[:3] - np.cross(start[-model.nv + 3 :][:3], start[-model.nv :][:3]), data.qacc[3:]]
        )
        expected = linked.rates(0.0, start)[-model.nv :]
        np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())


@pytest.mark.flight
@pytest.mark.parametrize("arm", ["two hinges", "hinge, slide, and another on the hull"])
def test_half_a_minute_in_a_current(arm):
    rng = np.random.default_rng(list(ARMS).index(arm))
    linked = arm_of(rng, *ARMS[arm])
    start = random_start(rng, len(linked.moving))
    expected = linked.reference(start, 30.0)
    assert apart(linked.flown(linked.model(0.005), start, 30.0), expected) < 1e-6


@pytest.mark.flight
@pytest.mark.parametrize(
    ("integrator", "order"), [("RK4", 4.0), ("implicit", 1.0), ("implicitfast", 1.0), ("Euler", 1.0)]
)
def test_order_of_convergence(integrator, order):
    """Added mass that lagged a step would be of first order under RK4, or worse."""
    rng = np.random.default_rng(4)
    linked = arm_of(rng, *ARMS["two hinges"])
    linear = replace(linked.hull, quadratic=np.zeros((6, 6)))
    links = tuple(replace(link, body=replace(link.body, quadratic=np.zeros((6, 6)))) for link in linked.links)
    linked = replace(linked, hull=linear, links=links)
    start = random_start(rng, 2)
    expected = linked.reference(start, 1.0)
    steps = (0.02, 0.01) if order > 1.0 else (0.002, 0.001)
    coarse, fine = (apart(linked.flown(linked.model(h, integrator), start, 1.0), expected) for h in steps)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.35)


def momenta(linked: Linked, model, data):
    """Linear and angular impulse (about the world's origin) of bodies and water, world axes, and kinetic energy."""
    linear, angular, energy = np.zeros(3), np.zeros(3), 0.0
    for k, body in enumerate([linked.hull, *(link.body for link in linked.links)], 1):
        R, velocity = data.xmat[k].reshape(3, 3), np.zeros(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, k, velocity, 1)
        V = np.concatenate([velocity[3:], velocity[:3]])
        momentum = (body.rigid + body.added) @ V
        p, h = R @ momentum[:3], R @ momentum[3:]
        linear, angular, energy = linear + p, angular + h + np.cross(data.xpos[k], p), energy + 0.5 * V @ momentum
    return linear, angular, energy


@pytest.mark.flight
@pytest.mark.parametrize("arm", ARMS)
def test_an_ideal_fluid_keeps_energy_and_impulse(arm):
    """20 s without drag and weight, the springs' energy counted; MuJoCo's kinetic energy is that of all of it."""
    rng = np.random.default_rng(10)
    linked = replace(arm_of(rng, *ARMS[arm], damped=False), gravity=0.0)
    model, start = linked.model(0.0025), random_start(rng, len(linked.moving))
    data = mujoco.MjData(model)
    linked.set_state(data, start)
    mujoco.mj_forward(model, data)
    linear, angular, energy = momenta(linked, model, data)
    assert data.energy[1] == pytest.approx(energy, rel=1e-12)
    whole = data.energy.sum()
    exchanged = []
    for _ in range(20):
        mujoco.mj_step(model, data, nstep=400)
        mujoco.mj_forward(model, data)
        exchanged.append(data.energy[0])
        assert data.energy.sum() == pytest.approx(whole, rel=1e-7)
        now = momenta(linked, model, data)
        np.testing.assert_allclose(now[0], linear, atol=1e-7 * np.linalg.norm(linear))
        np.testing.assert_allclose(now[1], angular, atol=1e-7 * np.linalg.norm(angular))
    assert max(exchanged) > 0.02 * whole  # the arm moved


def composite(linked: Linked) -> Body:
    """The hull with its links at joint position 0 as one body, without quadratic drag."""
    rigid, added, linear = linked.hull.rigid, linked.hull.added, linked.hull.linear
    volume, moment = linked.hull.volume, linked.hull.volume * linked.hull.cb
    poses = [(np.eye(3), np.zeros(3))]
    for link in linked.links:
        R, p = poses[link.parent]
        poses.append((R @ link.attitude, p + R @ link.place))
        X = inward(*poses[-1])
        rigid, added = rigid + X.T @ link.body.rigid @ X, added + X.T @ link.body.added @ X
        linear = linear + X.T @ link.body.linear @ X
        volume += link.body.volume
        moment = moment + link.body.volume * (poses[-1][1] + poses[-1][0] @ link.body.cb)
    mass = float(rigid[0, 0])
    cg = np.array([rigid[5, 1], rigid[3, 2], rigid[4, 0]]) / mass
    about_cg = rigid[3:, 3:] + mass * skew(cg) @ skew(cg)
    nothing = np.zeros((6, 6))
    return Body(mass, cg, about_cg, float(volume), moment / volume, added, linear, nothing, linked.hull.current)


def away_from_one_body(stiffness: float | None, friction: float, timestep: float) -> float:
    """How far a vehicle with a locked arm gets within 5 s from one body with the sums of all; no joints for None."""
    linked, nothing = arm_of(np.random.default_rng(3), *ARMS["two hinges"]), np.zeros((6, 6))
    links = tuple(
        replace(
            link,
            kind="none" if stiffness is None else "hinge",
            stiffness=stiffness or 0.0,
            friction=friction,
            body=replace(link.body, quadratic=nothing),
        )
        for link in linked.links
    )
    linked = replace(linked, hull=replace(linked.hull, quadratic=nothing), links=links)
    n, one = len(linked.moving), Linked(composite(linked), ())
    of_joints = [*range(7, 7 + n), *range(13 + n, 13 + 2 * n)]
    start = np.insert(random_start(np.random.default_rng(9), 0), [7] * n + [13] * n, 0.0)
    expected = one.flown(one.model(0.0005), np.delete(start, of_joints), 5.0)
    return apart(np.delete(linked.flown(linked.model(timestep), start, 5.0), of_joints), expected)


@pytest.mark.flight
def test_a_locked_arm_is_a_part_of_the_hull():
    """Without joints to rounding; stiff joints give way by as much less as they are stiffer."""
    assert away_from_one_body(None, 0.0, 0.001) < 1e-9
    soft, stiff = away_from_one_body(3e4, 30.0, 5e-4), away_from_one_body(3e5, 100.0, 2e-4)
    assert soft < 1e-4
    assert soft / stiff == pytest.approx(10.0, rel=0.05)


def test_a_link_in_a_current_that_changes_is_pushed_as_a_hull_is():
    """Fixed on a hull that has no water of its own but its volume: the same forces as on a hull with that water."""
    rng = np.random.default_rng(8)
    whole = random_body(rng)
    bare = replace(
        whole, volume=0.0, cb=np.zeros(3), added=np.zeros((6, 6)), linear=np.zeros((6, 6)), quadratic=np.zeros((6, 6))
    )
    massless = replace(whole, mass=1e-9, inertia_at_cg=1e-9 * np.eye(3), cg=np.zeros(3))
    carried = Linked(bare, (Link(massless, 0, np.zeros(3), np.eye(3), np.zeros(3), "none"),))
    table = {"water:current": np.ravel([[t, z, *rng.normal(size=3)] for t in (0.0, 0.4, 2.0) for z in (-3.0, 3.0)])}
    start = random_start(rng, 0)
    expected = Linked(whole, ()).flown(Linked(whole, ()).model(parameters=table), start, 2.0)
    assert apart(carried.flown(carried.model(parameters=table), start, 2.0), expected) < 1e-7


@pytest.mark.flight
def test_a_swinging_arm_that_bobs_keeps_its_energy():
    """Hull and links come out of the water and dive again: what fades does no work that is not stored."""
    rng = np.random.default_rng(5)
    linked = arm_of(rng, *ARMS["two hinges"], damped=False)
    light = replace(linked.hull, volume=1.3 * linked.hull.mass / 1000.0)
    linked = replace(linked, hull=light)
    model = linked.model(0.001, parameters={"water:surface": 0.0})
    data = mujoco.MjData(model)
    start = random_start(rng, 2)
    start[:3] = 0.0, 0.0, -0.05
    linked.set_state(data, start)
    heights, energies = [], []
    for _ in range(60):
        mujoco.mj_step(model, data, nstep=50)
        mujoco.mj_forward(model, data)
        heights.append(data.xpos[3, 2])
        energies.append(data.energy.sum() + buoyant_energy(linked, model, data))
    assert max(heights) > 0.0
    assert min(heights) < -0.1
    assert np.ptp(energies) < 1e-5 * np.ptp(heights) * 9.81 * linked.hull.mass


def buoyant_energy(linked: Linked, model, data) -> float:
    """rho g times the depth summed over what of the ellipsoids is under water, by their closed form (a sphere's)."""
    total = 0.0
    for k, body in enumerate([linked.hull, *(link.body for link in linked.links)], 1):
        radius = (0.75 * body.volume / np.pi) ** (1.0 / 3.0)
        depth = -(data.xpos[k] + data.xmat[k].reshape(3, 3) @ body.cb)[2]
        t = np.clip(depth / radius, -1.0, 1.0)
        # its derivative by the depth is the share under water, (1 + t)^2 (2 - t) / 4
        below = radius * (1.0 + t) ** 3 * (3.0 - t) / 16.0
        total += 1000.0 * 9.81 * body.volume * (below + max(depth - radius, 0.0))
    return total


def test_the_passive_callback_is_its_own_source_run_by_the_interpreter():
    rng = np.random.default_rng(1)
    linked = arm_of(rng, *ARMS["hinge, slide, and another on the hull"])
    table = np.ravel([[t, z, *rng.normal(size=3)] for t in (0.0, 0.4) for z in (-3.0, 3.0)])
    model = linked.model(parameters={"water:current": table, "water:surface": 0.3})
    compiled, interpreted = mujoco.MjData(model), mujoco.MjData(model)
    before, source = mujoco.get_mjcb_passive(), plain_callbacks.callbacks()["passive"]
    for seed in range(4):
        state = random_start(np.random.default_rng(seed), 3)
        for data in (compiled, interpreted):
            linked.set_state(data, state)
            data.time = 0.1 * seed
        mujoco.mj_forward(model, compiled)
        try:
            mujoco.set_mjcb_passive(lambda m, d: source(m._address, d._address))
            mujoco.mj_forward(model, interpreted)
        finally:
            mujoco.set_mjcb_passive(before)
        for name in ("M", "qLD", "qfrc_passive", "qacc"):
            fast, slow = getattr(compiled, name), getattr(interpreted, name)
            np.testing.assert_allclose(fast, slow, rtol=0.0, atol=1e-12 * np.abs(slow).max())


def test_a_stage_run_again_leaves_the_inertia_as_it_is():
    """Derivatives rerun the velocity stage on the matrix that holds added mass: it must not be added twice."""
    rng = np.random.default_rng(2)
    linked = arm_of(rng, *ARMS["two hinges"])
    model, start = linked.model(), random_start(rng, 2)
    data = mujoco.MjData(model)
    linked.set_state(data, start)
    mujoco.mj_forward(model, data)
    M, acceleration = data.M.copy(), data.qacc.copy()
    mujoco.mj_forwardSkip(model, data, mujoco.mjtStage.mjSTAGE_POS, 0)
    np.testing.assert_allclose(data.M, M, atol=1e-13 * np.abs(M).max())
    np.testing.assert_allclose(data.qacc, acceleration, atol=1e-11 * np.abs(acceleration).max())
    data.qacc[:] = acceleration
    mujoco.mj_inverse(model, data)
    assert np.abs(data.qfrc_inverse).max() < 1e-10 * np.abs(data.qfrc_passive).max()


def test_other_parameters_for_a_compiled_model():
    rng = np.random.default_rng(6)
    linked = arm_of(rng, *ARMS["two hinges"])
    other = replace(linked, links=(linked.links[0], replace(linked.links[1], body=random_link(rng, 1).body)))
    model, start = linked.model(), random_start(rng, 2)
    body = other.links[1].body
    cube_sim.set_parameters(
        model,
        {
            "fore:added_mass": body.added.ravel(),
            "fore:linear_damping": body.linear.ravel(),
            "fore:quadratic_damping": body.quadratic.ravel(),
            "fore:volume": [body.volume],
            "fore:centre_of_buoyancy": body.cb,
            "fore:mass": [body.mass],
            "fore:centre_of_mass": body.cg,
            "fore:inertia": body.inertia_at_cg[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]],
        },
    )
    assert apart(other.flown(model, start, 0.5), other.flown(other.model(), start, 0.5)) < 1e-9
    assert np.array_equal(model.body_invweight0.shape, other.model().body_invweight0.shape)
    np.testing.assert_allclose(model.dof_invweight0, other.model().dof_invweight0, rtol=1e-9)


def test_two_vehicles_with_arms_in_one_model_move_as_each_alone():
    """Behind the first one's joints, degrees of freedom and records of the second begin elsewhere."""
    rng = np.random.default_rng(12)
    each = [arm_of(rng, *ARMS[name]) for name in ("a part fixed on a link", "two hinges")]
    each = [replace(one, hull=replace(one.hull, current=(0.1, 0.0, 0.05))) for one in each]
    starts = [random_start(rng, len(one.moving)) for one in each]
    whole = mujoco.MjSpec()
    for name, one in zip("ab", each, strict=True):
        spec = mujoco.MjSpec.from_string(one.text(0.002))
        whole.option = spec.option
        whole.attach(spec, prefix=f"{name}/", frame=whole.worldbody.add_frame())
    model = cube_sim.load_model(whole)
    data, q, v = mujoco.MjData(model), 0, 0
    alone = []
    for one, start in zip(each, starts, strict=True):
        single = one.model(0.002)
        there = mujoco.MjData(single)
        one.set_state(there, start)
        data.qpos[q : q + single.nq], data.qvel[v : v + single.nv] = there.qpos, there.qvel
        q, v = q + single.nq, v + single.nv
        mujoco.mj_step(single, there, nstep=250)
        alone.append(np.concatenate([there.qpos, there.qvel]))
    mujoco.mj_step(model, data, nstep=250)
    n = len(each[0].moving)
    first = np.concatenate([data.qpos[: 7 + n], data.qvel[: 6 + n]])
    second = np.concatenate([data.qpos[7 + n :], data.qvel[6 + n :]])
    np.testing.assert_allclose(first, alone[0], atol=1e-10)
    np.testing.assert_allclose(second, alone[1], atol=1e-10)
    vehicle, single = cube_sim.Vehicle.from_model(model, "b/hull"), cube_sim.Vehicle.from_model(each[1].model())
    np.testing.assert_allclose(vehicle.added_mass, single.added_mass, atol=1e-12)
