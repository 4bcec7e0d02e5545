"""What gliders and profilers move by: a mass on a slide, and volume that is pumped out; against closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.water_bodies import DENSITY

import cube_sim

MASS, SLIDER, BELOW = 50.0, 4.0, 0.03
ADDED, DRAG = (5.0, 60.0, 60.0, 0.5, 8.0, 8.0), (20.0, 200.0, 200.0, 4.0, 30.0, 30.0)
FULL_LITRE, FASTEST = 1e-3, 5e-5  # of the bladder [m^3], [m^3/s]


def words(values) -> str:
    return " ".join(f"{float(value)!r}" for value in np.atleast_1d(values))


def model_of(damping=0.0, drag=(0.0,) * 6, gravity=9.81, below=BELOW, forces=None) -> mujoco.MjModel:
    """A neutral hull, its centre of mass below that of buoyancy, with a mass on a slide along it in its middle."""
    text = f"""<mujoco><option timestep="0.01" integrator="RK4" gravity="0 0 -{gravity}"/>
      <custom><numeric name="water:density" data="{DENSITY}"/>
        <numeric name="hull:volume" data="{(MASS + SLIDER) / DENSITY!r}"/>
        <numeric name="hull:added_mass" data="{words(ADDED)}"/>
        <numeric name="hull:linear_damping" data="{words([damping] * 6)}"/>
        <numeric name="hull:quadratic_damping" data="{words(drag)}"/></custom>
      <worldbody><body name="hull"><freejoint name="hull"/>
        <inertial pos="0 0 -{below}" mass="{MASS}" diaginertia="0.6 9 9"/>
        <body name="battery"><joint name="slide" type="slide" axis="1 0 0" range="-0.3 0.3" limited="true"/>
          <inertial pos="0 0 0" mass="{SLIDER}" diaginertia="0.01 0.01 0.01"/></body></body></worldbody>
      <actuator><position name="slide" joint="slide" kp="2000" kv="400" ctrlrange="-0.3 0.3"/></actuator></mujoco>"""
    return cube_sim.load_model(mujoco.MjSpec.from_string(text), forces=forces)


@pytest.mark.flight
@pytest.mark.parametrize("x", [0.05, -0.2])
def test_a_mass_moved_ahead_trims_the_hull(x):
    """tan(theta) = m x / (M z): the weights' moment about the centre of buoyancy is zero."""
    model = model_of(damping=20.0)
    data = mujoco.MjData(model)
    data.ctrl[0] = x
    mujoco.mj_step(model, data, nstep=12000)
    nose_down = -np.arcsin(data.xmat[1].reshape(3, 3)[2, 0])
    assert np.tan(nose_down) == pytest.approx(SLIDER * data.qpos[7] / (MASS * BELOW), rel=1e-4)
    assert data.qpos[7] == pytest.approx(x, abs=0.02)  # its own weight pulls it a little down the slope
    assert np.abs(data.qvel).max() < 1e-4


@pytest.mark.flight
def test_what_the_mass_gains_hull_and_water_lose():
    """Without drag and weight: (M + m + A) u + m s' = 0 at every step, and all rest where the mass does."""
    model = model_of(gravity=0.0, below=0.0)
    data = mujoco.MjData(model)
    data.ctrl[0], fastest = 0.2, 0.0
    for _ in range(400):
        mujoco.mj_step(model, data)
        assert (MASS + SLIDER + ADDED[0]) * data.qvel[0] + SLIDER * data.qvel[6] == pytest.approx(0.0, abs=1e-9)
        fastest = max(fastest, abs(data.qvel[0]))
    assert fastest > 0.01
    assert data.qpos[0] == pytest.approx(-SLIDER * data.qpos[7] / (MASS + SLIDER + ADDED[0]), rel=1e-6)
    assert data.qpos[7] > 0.15


def bladder(time, position, rotation, velocity, through_water, command, activation, state=(0.0,)):
    """Volume that is pumped out at a rate, to as much as is asked for; in the middle of the hull."""
    wanted = 1e-3 if time > 1.0 else 0.0
    rate = min(max(20.0 * (wanted - state[0]), -5e-5), 5e-5)
    lift = rotation.T @ np.array([0.0, 0.0, 1000.0 * 9.81 * state[0]])
    return (lift[0], lift[1], lift[2], 0.0, 0.0, 0.0), (rate,)


@pytest.mark.flight
def test_volume_pumped_out_lifts_the_hull():
    """Linearly in time until all of it is out; then the climb at which the drag is as large as the lift."""
    assert DENSITY == 1000.0
    model = model_of(drag=DRAG, forces={"hull": bladder})
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1100)
    assert data.act[-1] == pytest.approx(FASTEST * 10.0, rel=1e-3)
    mujoco.mj_step(model, data, nstep=5000)
    assert data.act[-1] == pytest.approx(FULL_LITRE, rel=1e-6)
    assert data.qvel[2] == pytest.approx(np.sqrt(DENSITY * 9.81 * FULL_LITRE / DRAG[2]), rel=1e-6)
