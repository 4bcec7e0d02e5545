"""The prediction of the motors against the activations of the flown model: equal to the last digit."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.edited_cube import edited

import cube_sim
from cube_sim.vehicle.motor_lag import MotorLag

DELAYS = [
    "",
    'delay="0.04" nsample="4"',
    'delay="0.035" nsample="6" interp="linear"',
    'delay="0.1" nsample="10" interp="cubic"',
    'actlimited="true" actrange="-1 1"',
]


@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize("motor", DELAYS)
@pytest.mark.parametrize("dyntype", ["filter", "filterexact"])
@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
def test_activations_are_mujocos_own(integrator, dyntype, motor, steps):
    model = cube_sim.load_model(edited(('dyntype="filter"', f'dyntype="{dyntype}" {motor}')))
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    model.actuator_dynprm[:, 0] = np.linspace(0.01, 0.2, 8)
    data = mujoco.MjData(model)
    lag = MotorLag(model, cube_sim.Vehicle.from_model(model).thrusters, steps)
    rng = np.random.default_rng(7)
    for _ in range(200):
        data.ctrl[:] = rng.uniform(-1.5, 1.5, 8)  # beyond the range too: it is cut off
        lag.advance(data.ctrl)
        mujoco.mj_forward(model, data)
        mujoco.mj_step(model, data, nstep=steps)
        np.testing.assert_array_equal(lag.activation, data.act)
    assert np.abs(data.act).max() > 0.1


def test_the_motors_of_one_hull_among_others():
    """In the order of the thrusters, whatever other actuators the model has."""
    reaction = '<general name="arm" joint="arm" dyntype="integrator"/>'
    arm = '<body pos="2 0 0"><joint name="arm"/><geom size=".1"/></body></worldbody>'
    model = cube_sim.load_model(edited(("<actuator>", f"<actuator>{reaction}"), ("</worldbody>", arm)))
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    lag, data = MotorLag(model, thrusters, 2), mujoco.MjData(model)
    for k in range(20):
        data.ctrl[:] = 0.1 * k
        data.ctrl[thrusters.actuators] = np.linspace(-1.0, 1.0, 8) * np.sin(k)
        lag.advance(data.ctrl[thrusters.actuators])
        mujoco.mj_step(model, data, nstep=2)
    np.testing.assert_array_equal(lag.activation, data.act[1:])
