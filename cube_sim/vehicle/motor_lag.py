"""The lag and the delay of the thrusters' motors, as MuJoCo integrates them.

What a thruster gives now follows from what it was commanded: delayed by the model's `delay`, through the lag of its
motor. MuJoCo does not follow the exponential of that lag. It takes steps of its integrator (Euler, RK4), reads the
delayed command from a buffer of one entry a step, and holds or interpolates between the entries. At a step of half the
lag that is already another curve. So the prediction is MuJoCo's own: a second model of the motors alone, without a
hull, stepped with the same commands. It agrees with the flown model to the last digit.
"""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.spatial import Vector
from cube_sim.vehicle.thrusters import Thrusters


class MotorLag:
    """The activations of m thrusters, from their commands alone.

    Attributes:
        model: of the motors alone.
        activation: (m,) the lagged commands, whose force the characteristics give. All 0 at first, as in new MjData.
    """

    def __init__(self, model: mujoco.MjModel, thrusters: Thrusters, steps: int) -> None:
        """Take the motors over from a model as it is now: time step, integrator, lags, delays, ranges.

        Args:
            model: made by `load_model`.
            thrusters: of one hull of it.
            steps: physics steps per call of `advance`.
        """
        self.model = _motors_alone(model, thrusters.actuators.tolist())
        self._data = mujoco.MjData(self.model)
        self._steps = steps
        self.activation = np.zeros(len(thrusters.names))

    def advance(self, commands: Vector) -> None:
        """Carry the motors over `steps` physics steps of constant commands (m,)."""
        self._data.ctrl[:] = commands
        mujoco.mj_step(self.model, self._data, nstep=self._steps)
        self.activation = self._data.act.copy()


def _motors_alone(model: mujoco.MjModel, actuators: list[int]) -> mujoco.MjModel:
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
    motors.opt.disableflags = model.opt.disableflags
    return motors
