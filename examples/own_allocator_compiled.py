"""An allocator of your own, compiled: the pseudo-inverse that goes on from its answer before.

python examples/own_allocator_compiled.py, or in a scenario beside this file
`allocation: {method: {python: own_allocator_compiled.py:steady}}`

Of all forces that make the wrench it takes those nearest to the forces of the tick before: they drift slowly to those
of least effort, and a thruster crosses its dead zone seldom. Inside it a thruster gives nothing; at its limit no more.
"""

from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.allocation import Status

ROOT = Path(__file__).parents[1]


def steady(setup, share=0.02):
    inverse = np.linalg.pinv(setup.A)
    idle = np.eye(len(setup.which)) - inverse @ setup.A  # what makes no wrench
    parameters = {"inverse": inverse, "idle": (1.0 - share) * idle, "limits": setup.limits}
    return cube_sim.compiled(allocate, parameters, memory={"before": np.zeros(len(setup.which))})


def allocate(wrench, p, m):  # the forces of the thrusters that respond [N]
    force = p.inverse @ wrench + p.idle @ m.before
    for i in range(len(force)):
        low, edge_low, edge_high, high = p.limits[i]
        force[i] = min(max(force[i], low), high)
        if edge_low < force[i] < edge_high:
            force[i] = edge_high if force[i] > edge_high / 2 else edge_low if force[i] < edge_low / 2 else 0.0
        m.before[i] = force[i]
    return force


def main() -> None:
    for vehicle in ("cube", "bluerov2_heavy"):
        settings = {"model": ROOT / "models" / f"{vehicle}.xml", "checks.3.at_most": 6.0}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", settings, allocator=steady)
        exact = np.mean(run.signals["allocation.status"][:, 1] == Status.EXACT)
        print(f"{vehicle}: {run.verdict}, {100 * exact:.1f} % of the wrenches exact, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
