"""What MuJoCo is told about a thruster: refused by the actuator's name unless its force is the characteristic's."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.edited_cube import T1, edited
from support.vehicles import vehicle

import cube_sim
from cube_sim.errors import ModelError


@pytest.mark.parametrize(
    ("attributes", "reason"),
    [
        ('dynprm="0"', "has a lag (dynprm) of 0 s; it is positive and finite"),
        ('dynprm="-0.02"', "has a lag (dynprm) of -0.02 s"),
        ('dynprm="nan"', "has a lag (dynprm) of nan s"),
        ('dynprm="inf"', "has a lag (dynprm) of inf s"),
        ('dyntype="integrator"', "has dyntype \"integrator\"; the lag of a motor is 'filter' or 'filterexact'"),
        ('dyntype="none"', 'without dyntype="filter"'),
        ('gainprm="1"', "has a gain of MuJoCo beside its characteristic"),
        ('gaintype="affine" gainprm="0 0 3"', "has a gain of MuJoCo beside its characteristic"),
        ('gear="1 0 0 0 0 0"', 'has gear "1 0 0 0 0 0"; a thruster pushes along its site\'s z axis'),
        ('gear="0 0.1 1 0 0 0"', "pushes along its site's z axis"),
        ('gear="0 0 1 0.1 0 0"', "pushes along its site's z axis"),
        ('gear="0 0 0 0 0 1"', "pushes along its site's z axis"),
        ('gear="0 0 nan 0 0 0"', "pushes along its site's z axis"),
        ('refsite="imu"', "has refsite 'imu'"),
        ('ctrlrange="-0.5 1"', "its ctrlrange [-0.5, 1] cuts off its curve, which runs from -1 to 1"),
        ('ctrlrange="-1 0.9"', "its ctrlrange [-1, 0.9] cuts off its curve"),
        ('actlimited="true" actrange="-0.9 1"', "its actrange [-0.9, 1] cuts off its curve"),
        ('forcelimited="true" forcerange="-30 60"', "its forcerange [-30, 60] cuts off its curve"),
    ],
)
def test_what_would_change_the_force_is_refused(attributes, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(edited((T1, f"{T1} {attributes}")))
    assert caught.value.element == "T1"
    assert reason in caught.value.reason


@pytest.mark.parametrize(
    ("replacements", "element", "reason"),
    [
        ([(T1, T1.replace('site="T1"', 'site="TX"'))], "T1", "no site 'TX'; the model has 9, the nearest T"),
        ([(T1, T1.replace(' name="T1"', ""))], "actuator 0", "no name"),
        (
            [("<worldbody>", '<worldbody><site name="pier"/>'), (T1, T1.replace('site="T1"', 'site="pier"'))],
            "T1",
            "its site 'pier' is on no body that has a name",
        ),
    ],
)
def test_a_thruster_on_nothing(replacements, element, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(edited(*replacements))
    assert caught.value.element == element
    assert reason in caught.value.reason


def test_a_hull_inside_another_body_has_no_free_joint():
    """And that is what is said, not that its carrier has no characteristic."""
    inside = edited(
        ('<freejoint name="hull"/>', ""),
        ('<body name="hull"', '<body name="o"><freejoint/><geom size=".1"/><body name="hull"'),
        ("</worldbody>", "</body></worldbody>"),
    )
    with pytest.raises(ModelError, match="hull: has water parameters but no free joint"):
        cube_sim.load_model(inside)


def test_thrust_and_reaction_torque_are_scaled_by_the_gear():
    """gear "0 0 g 0 0 k": g times the curve's force along the site's z axis, k times it about that axis."""
    g, k = -0.9, 0.03
    model = cube_sim.load_model(edited((T1, f'{T1} gear="0 0 {g} 0 0 {k}"')))
    whole = vehicle("cube").actuation_matrix[:, 0]
    column = cube_sim.Vehicle.from_model(model).actuation_matrix[:, 0]
    np.testing.assert_allclose(column, g * whole + np.concatenate([np.zeros(3), k * whole[:3]]), atol=1e-15)


@pytest.mark.parametrize("attributes", ["", ' ctrllimited="false"'])
def test_commands_end_where_the_curve_ends(attributes):
    """Without a ctrlrange a command of 5 would reach full thrust five times faster than the motor does."""
    free = edited((' ctrlrange="-1 1"', attributes) if attributes else ('\n               ctrlrange="-1 1"', ""))
    model = cube_sim.load_model(free, {"hull:thruster_characteristic": [-0.8, -30.0, 0.0, 0.0, 0.9, 40.0]})
    np.testing.assert_array_equal(model.actuator_ctrlrange, [[-0.8, 0.9]] * 8)
    assert model.actuator_ctrllimited.all()
    data = mujoco.MjData(model)
    data.ctrl[:] = 5.0
    mujoco.mj_step(model, data, nstep=100)
    np.testing.assert_allclose(data.act, 0.9, rtol=1e-9)


def test_a_wider_range_of_commands_ends_with_the_curve_too():
    model = cube_sim.load_model(edited((T1, f'{T1} ctrlrange="-5 5"')))
    np.testing.assert_array_equal(model.actuator_ctrlrange[:2], [[-1.0, 1.0], [-1.0, 1.0]])


LAG = 0.02
EVERY_STEP = np.inf


@pytest.mark.parametrize("dyntype", ["filter", "filterexact"])
@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
def test_a_lag_is_refused_just_where_mujocos_own_grows(integrator, dyntype):
    """Just below the limit a commanded thruster settles. Just above, an unguarded one would not."""
    limit = 2.785 if integrator == "RK4" else 2.0 if dyntype == "filter" else EVERY_STEP

    def thrusters(step: float) -> mujoco.MjModel:
        choice = ('timestep="0.01" integrator="RK4"', f'timestep="{step!r}" integrator="{integrator}"')
        return cube_sim.load_model(edited(choice, ('dyntype="filter"', f'dyntype="{dyntype}"')))

    def is_stable(model: mujoco.MjModel) -> bool:
        data = mujoco.MjData(model)
        data.ctrl[:] = 0.5
        for _ in range(2000):
            data.qvel[:], data.qpos[:] = 0.0, [0, 0, 0, 1, 0, 0, 0]
            mujoco.mj_step(model, data)
        return bool(np.all(np.abs(data.act - 0.5) < 1e-6))

    if limit == EVERY_STEP:
        assert is_stable(thrusters(10.0 * LAG))
        return
    model = thrusters(0.99 * limit * LAG)
    assert is_stable(model)
    model.opt.timestep = 1.01 * limit * LAG
    assert not is_stable(model)
    with pytest.raises(ModelError, match=r"T1: its lag of 0.02 s is unstable under \w+ with a time step of") as caught:
        thrusters(1.01 * limit * LAG)
    assert caught.value.element == "T1"
    assert "dyntype='filterexact', which is stable at any" in caught.value.reason
    assert ("integrator implicitfast" in caught.value.reason) == (integrator == "RK4")


@pytest.mark.parametrize(("delay_s", "samples"), [(0.1, 10), (0.035, 4), (0.0, 0), (0.1, 12)])
def test_a_delay_is_as_long_as_it_says(delay_s, samples):
    attributes = f' delay="{delay_s!r}" nsample="{samples}"' if samples else ""
    model = cube_sim.load_model(edited((T1, T1 + attributes)))
    data = mujoco.MjData(model)
    data.ctrl[:] = 1.0
    sent = 0
    while data.act[0] == 0.0:
        mujoco.mj_step(model, data)
        sent += 1
    assert (sent - 1) * 0.01 == pytest.approx(delay_s, abs=0.0101)


@pytest.mark.parametrize(
    ("attributes", "reason"),
    [
        ('delay="0.5" nsample="4"', "its delay of 0.5 s is cut off at 0.04 s"),
        ('delay="0.05" nsample="4"', "time step of 0.01 s; 5 are right"),
        ('delay="-0.1" nsample="4"', "has a delay of -0.1 s"),
    ],
)
def test_a_delay_the_buffer_cuts_off_is_refused(attributes, reason):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(edited((T1, f"{T1} {attributes}")))
    assert caught.value.element == "T1"
    assert reason in caught.value.reason
