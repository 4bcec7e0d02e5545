"""Every way of allocating on one and the same mission.

    python benchmarks/allocators.py [--scenario scenarios/cube_helix.yaml] [--duration 60] [--plot docs/allocators.png]

Flies the scenario once per allocator and prints reversals, and starts and stops, per minute and thruster, mean |F|^2,
the electrical energy of the forces made, wrench error (rms of demanded minus allocated, torques divided by the rms
lever arm), and what it did to the path: rms cross-track error over the last half. Saves the plot. The two
enumerations are left out: they make the forces of the exact search, in a third of a second a tick.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np

import cube_sim
from cube_sim.errors import CubeSimError
from cube_sim.scenario.loading import load
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter

REVERSAL, SWITCHING = "allocation.reversal_penalty_N2", "allocation.switching_penalty_N2"
FREE = {REVERSAL: 0.0, SWITCHING: 0.0}


def variants(thrusters: int) -> dict[str, dict]:
    """Every way of allocating, and what it changes in the scenario."""
    alternating = [15.0 * (-1) ** thruster for thruster in range(thrusters)]
    return {
        "exact, energy, may rest": FREE,
        "exact, energy, strict": {**FREE, "allocation.allow_off": False},
        "exact, energy + reversals": {**FREE, REVERSAL: 256.0},
        "exact, energy + reversals, strict": {**FREE, REVERSAL: 256.0, "allocation.allow_off": False},
        "exact, energy + reversals, switching": {REVERSAL: 256.0, SWITCHING: 256.0},
        "exact, F_opt of +-15 N (11)": {
            **FREE,
            "allocation.objective": "target",
            "allocation.target_N": alternating,
        },
        "exact, reactivity (10)": {**FREE, "allocation.objective": "reactivity"},
        "exact, reactivity by side": {**FREE, REVERSAL: 256.0, "allocation.objective": "reactivity_by_side"},
        "contraction": {"allocation.method": "contraction"},
        "compensation": {"allocation.method": "compensation"},
        "pseudo-inverse": {"allocation.method": "pseudo_inverse"},
        "clipped pseudo-inverse": {"allocation.method": "clipped_pseudo_inverse"},
    }


def reversals(force: np.ndarray) -> int:
    """Times a thruster pushes against the direction it last pushed to, rests passed over."""
    count = 0
    for column in force.T:
        signs = np.sign(column[column != 0.0])
        count += int(np.sum(signs[1:] != signs[:-1]))
    return count


def switches(force: np.ndarray) -> int:
    """Times a thruster starts from rest or comes to rest."""
    running = force != 0.0
    return int(np.sum(running[1:] != running[:-1]))


def fly(scenario: Path, changes: dict, duration: float, directory: Path, vehicle) -> dict[str, float]:
    run = cube_sim.run(scenario, {**changes, "duration_s": duration}, out=directory)
    signals = run.signals
    force = signals["thrusters.force_demanded"][:, 1:]
    time, made = signals["thrusters.force"][:, 0], signals["thrusters.force"][:, 1:]
    error = signals["wrench.demanded"][:, 1:] - signals["wrench.allocated"][:, 1:]
    error[:, 3:] /= lever_arm(vehicle.actuation_matrix, SPATIAL)
    cross = signals["path_error.cross_track"]
    late = cross[cross[:, 0] > 0.5 * time[-1], 1]
    return {
        "reversals / min": reversals(force) / force.shape[1] / (time[-1] / 60.0),
        "switches / min": switches(force) / force.shape[1] / (time[-1] / 60.0),
        "mean |F|^2 [N^2]": float(np.mean(np.sum(made**2, axis=1))),
        "energy [kJ]": vehicle.thrusters.energy(time, made) * 1e-3,
        "wrench error [N]": round(float(np.sqrt(np.mean(np.sum(error**2, axis=1)))), 9),
        "cross-track [m]": float(np.sqrt(np.mean(late**2))),
    }


def draw(results: dict[str, dict[str, float]], file: Path) -> None:
    columns = list(next(iter(results.values())))
    figure, axes = plt.subplots(1, len(columns), figsize=(16, 4.4), sharey=True, layout="constrained")
    names = list(results)
    for axis, column in zip(axes, columns, strict=True):
        values = np.array([results[name][column] for name in names])
        axis.barh(names, values, color=["#1f6f8b" if name.startswith("exact") else "#c26a3d" for name in names])
        axis.set_title(column, fontsize=10)
        if values.min() > 0.0 and values.max() / values.min() > 20.0:
            axis.set_xscale("log")
            axis.set_xlim(left=10.0 ** np.floor(np.log10(values.min())))
            axis.xaxis.set_minor_formatter(NullFormatter())
        axis.grid(axis="x", alpha=0.3)
        axis.tick_params(labelsize=8)
    axes[0].invert_yaxis()
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    here = Path(__file__).resolve().parents[1]
    parser.add_argument("--scenario", type=Path, default=here / "scenarios" / "cube_helix.yaml")
    parser.add_argument("--duration", type=float, default=60.0, help="simulated seconds of each flight")
    parser.add_argument("--plot", type=Path, default=here / "docs" / "allocators.png")
    options = parser.parse_args()

    try:
        model = load(options.scenario, {"duration_s": options.duration}).scenario.model
    except CubeSimError as error:
        parser.exit(2, f"{error}\n")
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(str(model)))
    results: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for number, (name, changes) in enumerate(variants(vehicle.actuation_matrix.shape[1]).items()):
            results[name] = fly(options.scenario, changes, options.duration, Path(scratch) / str(number), vehicle)
            if number == 0:
                print(f"{'allocator':<38}" + "".join(f"{column:>18}" for column in results[name]))
            print(f"{name:<38}" + "".join(f"{value:>18.4g}" for value in results[name].values()), flush=True)
    draw(results, options.plot)
    print(f"plot: {options.plot}")


if __name__ == "__main__":
    main()
