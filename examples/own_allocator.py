"""An allocator of your own: the pseudo-inverse, redistributed over the thrusters that are not saturated yet.

python examples/own_allocator.py, or in a scenario beside this file
`allocation: {method: {python: own_allocator.py:redistributed}}`

A thruster told a force inside its dead zone gives none, and one at its limit no more: each is set there in turn and the
others make up for it (redistributed pseudo-inverse: Johansen and Fossen, Control allocation - a survey, 2013). So it
often misses the wrench by a little where cube_sim's search makes it; the control law makes up for that.
"""

from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.allocation import Status

ROOT = Path(__file__).parents[1]


def redistributed(setup):
    low, edge_low, edge_high, high = setup.limits.T
    pinv = np.linalg.pinv

    def allocate(wrench):  # the forces of the thrusters that respond [N]
        force, free = np.zeros(len(low)), np.ones(len(low), dtype=bool)
        while free.any():
            force[free] = pinv(setup.A[:, free]) @ (wrench - setup.A[:, ~free] @ force[~free])
            inside = (force > edge_low) & (force < edge_high)
            allowed = np.where(inside, np.where(force > edge_high / 2, edge_high, 0.0), np.clip(force, low, high))
            allowed = np.where(inside & (force < edge_low / 2), edge_low, allowed)
            moved = np.where(free, np.abs(allowed - force), 0.0)
            if not moved.max() > 1e-9:
                break
            worst = moved.argmax()
            force[worst], free[worst] = allowed[worst], False
        return force

    return allocate


def main() -> None:
    for vehicle in ("cube", "bluerov2_heavy"):
        settings = {"model": ROOT / "models" / f"{vehicle}.xml", "checks.3.at_most": 3.0}
        run = cube_sim.fly(ROOT / "scenarios" / "cube_helix.yaml", settings, allocator=redistributed)
        exact = np.mean(run.signals["allocation.status"][:, 1] == Status.EXACT)
        print(f"{vehicle}: {run.verdict}, {100 * exact:.1f} % of the wrenches exact, recorded in {run.directory}")
        for check in run.checks:
            print(f"  {check.verdict}  {check.name}: {check.value:.3g}, {check.detail}")


if __name__ == "__main__":
    main()
