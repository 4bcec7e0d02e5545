"""What the motors turn at follows from their commands alone: equal, to the last digit, to motors without a vehicle."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.edited_cube import edited

import cube_sim
from cube_sim.vehicle.faults import set_efficiency, set_stuck

DELAYS = [
    "",
    'delay="0.04" nsample="4"',
    'delay="0.035" nsample="6" interp="linear"',
    'delay="0.1" nsample="10" interp="cubic"',
    'actlimited="true" actrange="-1 1"',
]


def motors_alone(model, actuators):
    """A model of these actuators' activations. They push a site of the world, with no force."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_site(name="site")
    for i in actuators:
        samples, interpolation = model.actuator_history[i].tolist()
        spec.add_actuator(
            name=model.actuator(i).name,
            trntype=mujoco.mjtTrn.mjTRN_SITE,
            target="site",
            dyntype=mujoco.mjtDyn(model.actuator_dyntype[i]),
            dynprm=model.actuator_dynprm[i],
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            gainprm=np.zeros(10),
            nsample=samples,
            interp=interpolation,
            delay=float(model.actuator_delay[i]),
            ctrllimited=bool(model.actuator_ctrllimited[i]),
            ctrlrange=model.actuator_ctrlrange[i],
            actlimited=bool(model.actuator_actlimited[i]),
            actrange=model.actuator_actrange[i],
        )
    motors = spec.compile()
    motors.opt.timestep, motors.opt.integrator = model.opt.timestep, model.opt.integrator
    return motors


@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize("motor", DELAYS)
@pytest.mark.parametrize("dyntype", ["filter", "filterexact"])
@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
def test_activations_follow_from_the_commands_whatever_fails(integrator, dyntype, motor, steps):
    model = cube_sim.load_model(edited(('dyntype="filter"', f'dyntype="{dyntype}" {motor}')))
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    model.actuator_dynprm[:, 0] = np.linspace(0.01, 0.2, 8)
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    data, motors = mujoco.MjData(model), motors_alone(model, range(8))
    alone = mujoco.MjData(motors)
    rng = np.random.default_rng(7)
    for k in range(200):
        if k == 50:
            set_efficiency(model, "T1", 0.3)
            set_efficiency(model, "T2", 0.0)
            set_stuck(model, "T3", 10.0)
        alone.ctrl[:] = data.ctrl[:] = rng.uniform(-1.5, 1.5, 8)  # beyond the range too: it is cut off
        mujoco.mj_step(motors, alone, nstep=steps)
        mujoco.mj_forward(model, data)
        mujoco.mj_step(model, data, nstep=steps)
        np.testing.assert_array_equal(alone.act, data.act[thrusters.activations])
    assert np.abs(data.act).max() > 0.1


def test_the_motors_of_one_hull_among_others():
    """In the order of the thrusters, whatever other actuators the model has."""
    reaction = '<general name="arm" joint="arm" dyntype="integrator"/>'
    arm = '<body pos="2 0 0"><joint name="arm"/><geom size=".1"/></body></worldbody>'
    model = cube_sim.load_model(edited(("<actuator>", f"<actuator>{reaction}"), ("</worldbody>", arm)))
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    np.testing.assert_array_equal(thrusters.activations, np.arange(1, 9))
