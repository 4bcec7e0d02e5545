"""Contact: added mass hits as hard as mass does.

A neutral hull in an ideal fluid whose added mass is the same in all three directions moves exactly like a dry body in
space with mass m + a and inertia I + A. So must it in every contact: momentum, restitution, friction, softness.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.water_bodies import DENSITY

import cube_sim

MASS, ADDED = 10.0, 14.0
INERTIA, ADDED_INERTIA = np.array([0.3, 0.4, 0.5]), np.array([0.5, 0.2, 0.1])


def wet(scene: str, names: tuple[str, ...], option: str):
    numerics = "".join(
        f'<numeric name="{n}:volume" data="{MASS / DENSITY}"/>'
        f'<numeric name="{n}:added_mass" data="{ADDED} {ADDED} {ADDED} {" ".join(map(str, ADDED_INERTIA))}"/>'
        for n in names
    )
    custom = f'<custom><numeric name="water:density" data="{DENSITY}"/>{numerics}</custom>'
    return cube_sim.load_model(mujoco.MjSpec.from_string(assemble(scene, MASS, INERTIA, custom, option)))


def dry(scene: str, names: tuple[str, ...], option: str):
    spec = mujoco.MjSpec.from_string(assemble(scene, MASS + ADDED, INERTIA + ADDED_INERTIA, "", option))
    spec.option.gravity = np.zeros(3)
    for name in names:
        spec.body(name).simple = 0
    return spec.compile()


def assemble(scene: str, mass: float, inertia: np.ndarray, custom: str, option: str) -> str:
    inertial = f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{" ".join(map(str, inertia))}"/>'
    return f"<mujoco>{option}{custom}<worldbody>{scene.replace('INERTIAL', inertial)}</worldbody></mujoco>"


HULL = """<body name="{name}" pos="{pos}"><freejoint/>INERTIAL
  <geom type="box" size="0.25 0.2 0.15" friction="{friction} 0.005 0.0001" solref="{solref}"/></body>"""
WALL = '<geom type="plane" pos="1.0 0 0" zaxis="-1 0 0.1" size="5 5 1" friction="{friction}" solref="{solref}"/>'


def both_fly(scene, names, option, velocities, steps):
    """qpos and qvel of the wet and the dry model after the same flight, and whether anything touched."""
    ends, touched = [], False
    for model in (wet(scene, names, option), dry(scene, names, option)):
        data = mujoco.MjData(model)
        data.qvel[:] = velocities
        for _ in range(steps):
            mujoco.mj_step(model, data)
            touched |= data.ncon > 0
        ends.append(np.concatenate([data.qpos, data.qvel]))
    assert touched
    return ends


# implicitfast takes the gyroscopic terms of the dry body implicitly and the water's explicitly: equal to first order.
OPTIONS = [
    '<option integrator="Euler" timestep="0.002" solver="Newton"/>',
    '<option integrator="implicitfast" timestep="0.002" solver="Newton" cone="elliptic"/>',
    '<option integrator="RK4" timestep="0.005" solver="Newton"/>',
    '<option integrator="Euler" timestep="0.002" solver="CG" iterations="200" tolerance="1e-12"/>',
    '<option integrator="RK4" timestep="0.005" solver="PGS" iterations="200" tolerance="1e-12"/>',
    '<option integrator="Euler" timestep="0.002" solver="PGS" jacobian="sparse" iterations="200" tolerance="1e-12"/>',
    '<option integrator="Euler" timestep="0.002" noslip_iterations="5" cone="elliptic"/>',
]


def tolerance(option: str) -> float:
    return 1e-3 if "implicitfast" in option else 1e-6


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize(("friction", "solref"), [("0", "0.02 1"), ("0.8", "0.02 1"), ("0.5", "-20000 -30")])
def test_a_corner_hits_a_wall_obliquely(option, friction, solref):
    scene = HULL.format(name="hull", pos="0 0 0", friction=friction, solref=solref)
    scene += WALL.format(friction=friction, solref=solref)
    velocity = np.array([1.2, 0.3, -0.1, 0.4, -0.7, 0.9])
    got, expected = both_fly(scene, ("hull",), option, velocity, 600)
    assert np.sign(expected[7]) == -1.0  # it came back
    np.testing.assert_allclose(got, expected, atol=tolerance(option))


@pytest.mark.parametrize("option", [OPTIONS[0], OPTIONS[1], OPTIONS[5]])
def test_two_hulls_collide(option):
    """Both with added mass, and apart from each other in islands of their own before they touch."""
    scene = HULL.format(name="left", pos="-0.6 0.05 0", friction="0.5", solref="0.02 1")
    scene += HULL.format(name="right", pos="0.6 -0.05 0.1", friction="0.5", solref="0.02 1")
    scene += WALL.format(friction="0.5", solref="0.02 1")
    velocity = np.array([0.8, 0.0, 0.1, 0.3, 0.2, -0.4, -0.7, 0.1, 0.0, -0.2, 0.5, 0.1])
    got, expected = both_fly(scene, ("left", "right"), option, velocity, 900)
    np.testing.assert_allclose(got, expected, atol=tolerance(option))


def pressed_against_the_wall() -> mujoco.MjModel:
    scene = HULL.format(name="hull", pos="0.7 0 0", friction="0.5", solref="0.02 1")
    return wet(scene + WALL.format(friction="0.5", solref="0.02 1"), ("hull",), '<option timestep="0.002"/>')


def test_solver_chosen_after_loading():
    """Newton, CG and PGS, each run to its end, agree on one problem: they see the same inertia."""
    model, ends = pressed_against_the_wall(), []
    model.opt.iterations, model.opt.tolerance = 1000, 1e-14
    for solver in (mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtSolver.mjSOL_CG, mujoco.mjtSolver.mjSOL_PGS):
        model.opt.solver = solver
        data = mujoco.MjData(model)
        data.qvel[0] = 0.5
        touched = False
        for _ in range(200):
            mujoco.mj_step(model, data)
            touched |= data.nefc > 0
        assert touched
        ends.append(data.qvel.copy())
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-7)
    np.testing.assert_allclose(ends[2], ends[0], atol=1e-7)


def test_derivatives_in_contact_do_not_depend_on_the_solver():
    """mjd_transitionFD runs the passive stage again and again on one set of contacts."""
    model, found = pressed_against_the_wall(), []
    model.opt.iterations, model.opt.tolerance = 1000, 1e-16
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 30.0
    mujoco.mj_step(model, data, nstep=500)
    for solver in (mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtSolver.mjSOL_PGS):
        model.opt.solver = solver
        A = np.zeros((12, 12))
        mujoco.mjd_transitionFD(model, data, 1e-5, True, A, None, None, None)
        found.append(A)
    assert data.nefc > 0
    np.testing.assert_allclose(found[1], found[0], atol=1e-4)


def test_elastic_rebound_keeps_the_speed():
    """A contact that is a spring without a damper gives back what it took."""
    scene = HULL.format(name="hull", pos="0 0 0", friction="0", solref="-20000 0")
    scene += '<geom type="plane" pos="0.6 0 0" zaxis="-1 0 0" size="5 5 1" friction="0" solref="-20000 0"/>'
    model = wet(scene, ("hull",), '<option integrator="RK4" timestep="0.0005"/>')
    data = mujoco.MjData(model)
    data.qvel[0] = 0.8
    mujoco.mj_step(model, data, nstep=3000)
    assert data.ncon == 0
    assert data.qvel[0] == pytest.approx(-0.8, rel=0.02)


def test_a_hull_rests_against_a_spring_equality():
    """Soft constraints use the inverse weights: a weld to the world responds as it does to a dry twin."""
    scene = HULL.format(name="hull", pos="0 0 0", friction="0", solref="0.02 1")
    results = []
    for make in (wet, dry):
        model = make(
            scene + "</worldbody><equality><connect body1='hull' anchor='0 0 0'/></equality><worldbody>",
            ("hull",),
            '<option integrator="implicitfast" timestep="0.002"/>',
        )
        data = mujoco.MjData(model)
        data.qfrc_applied[:3] = 50.0, -20.0, 30.0
        mujoco.mj_step(model, data, nstep=200)
        results.append(data.qpos.copy())
    np.testing.assert_allclose(*results, atol=1e-9)
    assert np.abs(results[0][:3]).max() > 1e-5


ARMED = """<body name="hull"><freejoint/>INERTIAL<geom type="box" size="0.25 0.2 0.15" mass="0"/>
  <site name="eye" pos="0 0 0.2"/>
  <body pos="0.3 0 0"><joint name="hinge" axis="0 1 0.2"/><geom type="capsule" size="0.03" fromto="0 0 0 0.3 0.1 0"/>
  <body pos="0.3 0.1 0"><joint name="ball" type="ball"/><geom type="box" size="0.05 0.1 0.02"/><site name="tip"/>
  <body pos="0.1 0 0"><joint name="slide" type="slide" axis="1 0 0"/><geom size="0.04"/></body></body></body></body>
  </worldbody><tendon><spatial name="rope"><site site="eye"/><site site="tip"/></spatial></tendon><worldbody>"""


def test_inverse_weights_of_a_hull_with_an_arm_are_its_dry_twins():
    """Bodies, joints of every kind, and a tendon from hull to arm: as MuJoCo computes them for real mass."""
    models = [make(ARMED, ("hull",), '<option timestep="0.002"/>') for make in (wet, dry)]
    for name in ("body_invweight0", "dof_invweight0", "tendon_invweight0"):
        got, expected = (getattr(model, name) for model in models)
        np.testing.assert_allclose(got, expected, rtol=1e-9, err_msg=name)
