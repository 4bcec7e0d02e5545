"""Servos too stiff for the time step: the step that is told is the one up to which MuJoCo carries the joint."""

import mujoco
import numpy as np
import pytest
from support.ballasted import MODEL, ballasted

import cube_sim
from cube_sim.scenario import load_mapping
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.servo_stiffness import stiff_servo_words
from cube_sim.vehicle.vehicle import Vehicle

SERVO = 'kp="2000" kv="400"'


def slider(integrator="RK4", kp=2000.0, kv=400.0, damping=0.0):
    text = MODEL.replace(SERVO, f'kp="{kp}" kv="{kv}"').replace('integrator="RK4"', f'integrator="{integrator}"')
    text = text.replace('range="-0.3 0.3"/>', f'damping="{damping}"/>', 1)
    model = load_unsaid(mujoco.MjSpec.from_string(text))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model


def longest_step(model):
    """As the words have it, which say it for any step that is too long."""
    model.opt.timestep = 10.0
    (said,) = stiff_servo_words(model, model.body("hull").id)
    return float(said.split("beyond ")[1].split(" s")[0])


def explodes(model, step):
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[2], data.qpos[7] = -50.0, 1e-4
    for _ in range(2000):
        mujoco.mj_step(model, data)
        if not abs(data.qvel[6]) < 1e3:
            return True
    return False


@pytest.mark.parametrize("integrator", ["RK4", "Euler", "implicitfast"])
@pytest.mark.parametrize(
    ("kp", "kv", "damping"), [(2e3, 0, 0), (1e6, 400, 0), (1e5, 3e3, 0), (1e5, 0, 3e3), (3e4, 300, 300)]
)
def test_the_step_that_is_told_is_the_longest_that_carries_the_joint(integrator, kp, kv, damping):
    model = slider(integrator, kp, kv, damping)
    longest = longest_step(model)
    assert not explodes(model, 0.9 * longest)
    assert explodes(model, 1.1 * longest)


def test_a_spring_in_closed_form():
    """RK4 carries an undamped spring up to a step of 2 sqrt(2) over its frequency, semi-implicit Euler up to 2."""
    inertia = 1.0 / float(slider().dof_invweight0[6])
    frequency = np.sqrt(1e5 / inertia)
    for integrator, factor in (("RK4", np.sqrt(8.0)), ("Euler", 2.0), ("implicitfast", 2.0)):
        assert longest_step(slider(integrator, 1e5, 0.0)) == pytest.approx(factor / frequency, rel=0.05)


def test_implicit_damping_is_not_stiff_and_what_is_as_usual_is_not_told():
    model = slider("implicitfast", 100.0, 1e6)
    model.opt.timestep = 10.0
    assert stiff_servo_words(model, model.body("hull").id) == []
    assert stiff_servo_words(slider(), 1) == []
    assert stiff_servo_words(slider(kp=-1e6), 1) == []  # it grows by itself, whatever the step


def test_the_note_names_the_stiffest_servo_and_what_would_be_right():
    model = slider(kp=1e6)
    (said,) = stiff_servo_words(model, Vehicle.from_model(model).body)
    assert said.startswith(
        "the servo 'battery' (kp 1e+06, kv 400) of joint 'slide' is stiff for the time step of 0.01 s"
    )
    model.opt.timestep = float(said.split("take a step of ")[1].split(" s")[0])
    assert stiff_servo_words(model, 1) == []


@pytest.mark.flight
def test_a_run_that_explodes_names_the_servo(tmp_path):
    given = ballasted(tmp_path, duration_s=2, events=[], checks=[{"kind": "allowed_forces"}])
    model = tmp_path / "ballasted.xml"
    model.write_text(MODEL.replace(SERVO, 'kp="4e6" kv="6e5"'))
    run = cube_sim.run(load_mapping(given), out=tmp_path / "out")
    assert run.ended_early is not None
    assert run.ended_early.time_s < 2.0
    assert "; most likely because the servo 'battery' (kp 4e+06, kv 600000) of joint 'slide' is stiff" in str(
        run.ended_early.reason
    )
    told = [line.text for line in run.log if line.level == "WARNING"]
    assert any(text.startswith("the servo 'battery'") for text in told)
