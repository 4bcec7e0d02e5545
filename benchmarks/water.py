"""What the water costs: microseconds of processor time per MuJoCo step, as ratios within one run.

    python benchmarks/water.py [--steps N] [--repeats N] [--json]

Variants of the CUBE, each under Euler at 2 ms and RK4 at 10 ms:

    bare            MuJoCo alone: no water, thrust as plain forces; the hull's inertia is diagonal, and MuJoCo knows it
    bare, full      the same with all 21 entries of the hull's inertia, which is where water starts from
    water           added mass, drag, buoyancy, current
    water+thrusters and the thruster characteristics
    user force      and a user's own compiled force (a spring); "as Python" is the same, not compiled
    numpy           the same water as the best plain numpy callback we could write

Then the whole model through mujoco.rollout and mujoco.batch on one thread and on two, in wall time.
Medians over the repeats; variants take turns, so that a busy machine slows them all alike.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from types import SimpleNamespace

import mujoco
import numpy as np
from mujoco import batch, rollout

import cube_sim
from cube_sim.vehicle.plugin import hook, packing

CUBE = Path(__file__).parents[1] / "models" / "cube.xml"
INTEGRATORS = {"Euler": (mujoco.mjtIntegrator.mjINT_EULER, 0.002), "RK4": (mujoco.mjtIntegrator.mjINT_RK4, 0.01)}
TETHER = SimpleNamespace(stiffness=1.0)


def spring(time, position, rotation, velocity, through_water):
    f = rotation.T @ (-1.0 * position)
    return f[0], f[1], f[2], 0.0, 0.0, 0.0


def spring_as_python(time, position, rotation, velocity, through_water):
    f = rotation.T @ (-TETHER.stiffness * position)  # an attribute of an object: numba does not compile it
    return f[0], f[1], f[2], 0.0, 0.0, 0.0


def plain_motors() -> mujoco.MjSpec:
    """The CUBE with thrusters whose force is the lagged command itself, so that no callback has any work."""
    spec = mujoco.MjSpec.from_file(str(CUBE))
    for actuator in spec.actuators:
        actuator.biastype = mujoco.mjtBias.mjBIAS_NONE
        actuator.gainprm[0] = 20.0
    return spec


def with_full_inertia() -> mujoco.MjModel:
    """MuJoCo alone, with room in M for what added mass couples: where the numpy callback works."""
    spec = plain_motors()
    spec.body("hull").simple = 0
    return spec.compile()


def only_water() -> mujoco.MjModel:
    spec = plain_motors()
    for numeric in list(spec.numerics):
        if ":thruster_" in numeric.name:
            spec.delete(numeric)
    return cube_sim.load_model(spec)


def numpy_callback(model: mujoco.MjModel) -> Callable[[mujoco.MjModel, mujoco.MjData], None]:
    """The same law in numpy, with everything that can be prepared outside the step."""
    vehicle = cube_sim.Vehicle.from_model(model)
    M_A, D, D_q = vehicle.added_mass, vehicle.linear_damping, vehicle.quadratic_damping
    whole = vehicle.mass_matrix + M_A
    lift, r = vehicle.displaced_mass * 9.81, vehicle.centre_of_buoyancy
    rows, columns = np.tril_indices(6)
    B = np.zeros((6, 6))
    B[3:, 3:] = np.eye(3)
    nu = np.zeros(6)

    def cross(a, b):
        return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])

    def passive(m, d):
        R = d.xmat[1].reshape(3, 3)
        B[:3, :3] = R.T
        d.M[:21] = (B.T @ whole @ B)[rows, columns]
        mujoco.mj_factorM(m, d)
        qvel = d.qvel
        nu[:3], nu[3:] = (qvel[:3] - m.opt.wind) @ R, qvel[3:6]
        v, w = nu[:3], nu[3:]
        p = M_A @ nu
        F = M_A[:, :3] @ cross(w, v) - D @ nu - D_q @ (np.abs(nu) * nu)
        F[:3] -= cross(w, p[:3])
        F[3:] -= cross(v, p[:3]) + cross(w, p[3:])
        f = R[2] * lift
        F[:3] += f
        F[3:] += cross(r, f)
        d.qfrc_passive[:6] += B.T @ F

    return passive


def started(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qvel[:] = [0.3, -0.2, 0.1, 0.2, 0.1, -0.3]
    data.ctrl[:] = [0.3, -0.5, 0.4, 0.1, 0.0, 0.6, -0.4, 0.2]
    return data


def processor_us(model: mujoco.MjModel, steps: int, callback: Callable | None = None) -> float:
    """Microseconds of processor time per step; `callback` stands in for the compiled water."""
    data = started(model)
    if callback is not None:
        mujoco.set_mjcb_passive(callback)
    mujoco.mj_step(model, data, nstep=20)
    begin = time.process_time_ns()
    mujoco.mj_step(model, data, nstep=steps)
    spent = time.process_time_ns() - begin
    if callback is not None:
        mujoco.set_mjcb_passive(None)
        hook.install()
    return spent / steps / 1e3


def single(integrator: str, steps: int, repeats: int) -> dict[str, float]:
    models = {
        "bare": plain_motors().compile(),
        "bare, full": with_full_inertia(),
        "water": only_water(),
        "water+thrusters": cube_sim.load_model(CUBE),
        "user force": cube_sim.load_model(CUBE, forces={"hull": spring}),
        "user force as Python": cube_sim.load_model(CUBE, forces={"hull": spring_as_python}),
    }
    for model in models.values():
        model.opt.integrator, model.opt.timestep = INTEGRATORS[integrator]
    callback, room = numpy_callback(models["water+thrusters"]), with_full_inertia()
    room.opt.integrator, room.opt.timestep = INTEGRATORS[integrator]
    times: dict[str, list[float]] = {name: [] for name in [*models, "numpy"]}
    for _ in range(repeats):
        for name, model in models.items():
            few = steps // 10 if name.endswith("Python") else steps
            times[name].append(processor_us(model, few))
        times["numpy"].append(processor_us(room, steps // 10, callback))
    return {name: median(values) for name, values in times.items()}


def in_bulk(simulations: int, steps: int, repeats: int) -> dict[str, float]:
    """Microseconds of wall time per step of the whole model, for all ways of running many."""
    model = cube_sim.load_model(CUBE)
    data = started(model)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.zeros(mujoco.mj_stateSize(model, full))
    mujoco.mj_getState(model, data, state, full)
    initial = np.tile(state, (simulations, 1))
    control = np.tile(data.ctrl, (simulations, steps, 1))
    fleets = {n: batch.Batch(model, nsim=simulations, nthread=n) for n in (1, 2)}
    for fleet in fleets.values():
        fleet.ctrl[:] = data.ctrl
        fleet.qvel[:] = data.qvel
    ways: dict[str, Callable[[], object]] = {}
    with rollout.Rollout(nthread=2) as two, rollout.Rollout(nthread=0) as one:
        many = [mujoco.MjData(model), mujoco.MjData(model)]
        ways["rollout, 1 thread"] = lambda: one.rollout(model, many[:1], initial, control)
        ways["rollout, 2 threads"] = lambda: two.rollout(model, many, initial, control)
        ways["batch, 1 thread"] = lambda: fleets[1].step(nstep=steps)
        ways["batch, 2 threads"] = lambda: fleets[2].step(nstep=steps)
        times: dict[str, list[float]] = {name: [] for name in ways}
        for _ in range(repeats):
            for name, way in ways.items():
                begin = time.perf_counter_ns()
                way()
                times[name].append((time.perf_counter_ns() - begin) / (simulations * steps) / 1e3)
    return {name: min(values) for name, values in times.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=5000, help="steps per measurement")
    parser.add_argument("--repeats", type=int, default=9, help="measurements per variant")
    parser.add_argument("--json", action="store_true", help="print numbers instead of a table")
    options = parser.parse_args()
    begin = time.perf_counter()
    hook.install()
    start_s = time.perf_counter() - begin
    results = {name: single(name, options.steps, options.repeats) for name in INTEGRATORS}
    bulk = in_bulk(64, max(20, options.steps // 20), options.repeats)
    size = packing.packed_parameters(cube_sim.load_model(CUBE)).size
    if options.json:
        print(json.dumps({"start_s": start_s, "us_per_step": results, "bulk_us_per_step": bulk}))
        return
    print(f"MuJoCo {mujoco.__version__}, the CUBE ({size} packed numbers), water ready after {start_s:.3f} s\n")
    print(f"{'':24}" + "".join(f"{name + ' [us/step]':>18}{'x bare':>9}" for name in results))
    for variant in next(iter(results.values())):
        cells = "".join(f"{times[variant]:18.2f}{times[variant] / times['bare']:9.2f}" for times in results.values())
        print(f"{variant:24}{cells}")
    print(f"\n{'RK4, 64 simulations':24}{'[us/step]':>18}{'x 1 thread':>12}")
    for kind in ("rollout", "batch"):
        one = bulk[f"{kind}, 1 thread"]
        for threads in ("1 thread", "2 threads"):
            value = bulk[f"{kind}, {threads}"]
            print(f"{kind + ', ' + threads:24}{value:18.2f}{one / value:12.2f}")


if __name__ == "__main__":
    main()
