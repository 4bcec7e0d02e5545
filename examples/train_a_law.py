"""Train a small law to keep a place in unknown currents, then hold it against our own by the same checks.

python examples/train_a_law.py [--generations 10] [--laws 16] [--out trained_law.json]

The law has six numbers: how much force and torque an error, its integral and a velocity call for. The
cross-entropy method (R. Rubinstein, 1999) finds them on an environment of Gymnasium: draw laws around a mean, fly each
in other currents with other hulls, move mean and spread to the best of them. Numpy is all it needs.
"""

import argparse
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import cube_sim
from cube_sim.gym import FlightEnv, FollowingReward

SCENARIO = {
    "schema_version": 1,
    "name": "kept_place",
    "model": Path(__file__).parents[1] / "models" / "cube.xml",
    "duration_s": 20.0,
    "control_period_s": 0.05,
    "path": {"type": "point", "position_m": [0.0, 0.0, -5.0]},
    "initial": {"position_m": [0.5, -0.5, -5.5]},
    "guidance": {"speed_m_s": 0.4},
    "checks": [
        *(
            {"kind": "signal", "signal": f"path_error.{name}", "statistic": "max_abs", "from_s": 15, "at_most": most}
            for name, most in (("cross_track", 0.03), ("along", 0.03), ("attitude", 0.02))
        ),
        {"kind": "allowed_forces"},
        {"kind": "exact_wrench"},
    ],
}
CURRENT_M_S = 0.25
"""Largest component of the currents it learns in."""
RANDOM = {
    "scenario": {
        "current_m_s": [[-CURRENT_M_S] * 3, [CURRENT_M_S] * 3],
        "initial.position_m": [[-0.7, -0.7, -5.7], [0.7, 0.7, -4.3]],
        "initial.attitude_deg": [[-20.0, -20.0, -90.0], [20.0, 20.0, 90.0]],
    },
    "model": {"hull:added_mass": [0.8, 1.2], "hull:quadratic_damping": [0.7, 1.3]},
}
UNSEEN = ([0.2, 0.0, 0.0], [0.0, -0.15, 0.1], [-0.15, 0.15, -0.05])
"""Currents it is judged in [m/s]."""
BEST, FLIGHTS = 4, 2
"""Laws that the next generation is drawn around, and flights of each."""


class TrainedLaw:
    """Error, integral and velocity -> wrench, with six gains.

    Args:
        gains: (6,) [N/m, N/(m s), N s/m, N m/rad, N m/(rad s), N m s/rad].
        period_s: of its ticks [s].
    """

    def __init__(self, gains, period_s):
        self.gains, self.period_s, self.total = np.asarray(gains), period_s, np.zeros(6)

    def wrench(self, error, velocity):
        """(6,) [N, N m] of the way and turn to the target (6,) [m, rad] and the velocity (6,), all in body axes."""
        near = np.linalg.norm(error[:3]) < 0.5  # far away the integral would only wind up
        self.total = self.total + near * self.period_s * error
        kp, ki, kd = (np.repeat(self.gains[k::3], 3) for k in range(3))
        return kp * error + ki * self.total - kd * velocity


def trained_law(setup, gains):
    """The factory that a scenario names in `control.law`, or that `cube_sim.fly` is given."""
    law = TrainedLaw(gains, setup.period_s)
    return lambda aim: law.wrench(aim.error, np.concatenate([aim.state.velocity, aim.state.rates]))


def worth(env, gains, seed):
    """What a flight earns."""
    seen, _ = env.reset(seed=seed)
    law, at = TrainedLaw(gains, env.flight.mission.scenario.control_period_s), env.layout.at
    earned, over = 0.0, False
    while not over:
        error = np.concatenate([seen[at("ways")][:3], seen[at("attitude")]])
        velocity = np.concatenate([seen[at("velocity")], seen[at("rates")]])
        seen, reward, terminated, truncated, _ = env.step(env.scale.share(law.wrench(error, velocity)))
        earned, over = earned + reward, terminated or truncated
    return earned


def train(generations, count, seed=1):
    """(6,) gains, found among so many laws a generation."""
    env = FlightEnv(SCENARIO, randomise=RANDOM, reward=FollowingReward(near_m=0.1, near_rad=0.1, effort=0.5))
    rng = np.random.default_rng(seed)
    mean, spread = np.log([10.0, 1.0, 10.0, 1.0, 0.1, 1.0]), np.full(6, 1.2)
    for generation in range(generations):
        laws = mean + spread * rng.standard_normal((count, 6))
        flights = rng.integers(2**31, size=FLIGHTS).tolist()  # the same for all laws of a generation
        earned = np.array([np.mean([worth(env, np.exp(law), flight) for flight in flights]) for law in laws])
        best = laws[np.argsort(earned)[-BEST:]]
        mean, spread = best.mean(axis=0), np.maximum(0.7 * best.std(axis=0) + 0.3 * spread * 0.8, 0.02)
        print(f"generation {generation + 1:2d}: best {earned.max():6.2f}, mean {earned.mean():6.2f} of 20", flush=True)
    return np.exp(mean)


def compare(gains):
    """Fly both in currents neither has seen, and print what the checks say."""
    print("\ncurrent [m/s]           law       verdict  across [mm]  along [mm]  attitude [mrad]  energy [J]")
    for current in UNSEEN:
        for name, controller in (("trained", lambda setup: trained_law(setup, gains)), ("ours", None)):
            with TemporaryDirectory() as folder:
                run = cube_sim.fly(SCENARIO, {"current_m_s": current}, controller=controller, out=Path(folder) / "run")
            across, along, attitude = (1e3 * check.value for check in run.checks[:3])
            energy = run.signals["power.energy"][-1, 1]
            numbers = f"{across:11.1f}{along:12.1f}{attitude:17.1f}{energy:12.0f}"
            print(f"{current!s:24}{name:10}{run.verdict:7}{numbers}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--generations", type=int, default=10)
    parser.add_argument("--laws", type=int, default=16, help="of a generation")
    parser.add_argument("--out", type=Path, default=Path("trained_law.json"))
    asked = parser.parse_args()
    gains = train(asked.generations, asked.laws)
    asked.out.write_text(json.dumps({"gains": gains.tolist()}), encoding="utf-8")
    print(f"\n{asked.out}: gains {np.array2string(gains, precision=3)}")
    compare(gains)


if __name__ == "__main__":
    main()
