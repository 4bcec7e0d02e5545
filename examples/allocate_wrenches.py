"""Allocate wrenches: what a dead zone does to the pseudo-inverse, and what the exact allocation makes of it.

python examples/allocate_wrenches.py
"""

from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.allocation import Allocation, make_allocator

MODEL = Path(__file__).parents[1] / "models" / "cube.xml"
DEAD_ZONE_N = (-2.0, 2.0)


def main() -> None:
    model = cube_sim.load_model(MODEL, {"hull:thruster_dead_zone": DEAD_ZONE_N})
    vehicle = cube_sim.Vehicle.from_model(model)
    A, limits = vehicle.actuation_matrix, vehicle.thrusters.limits  # (6, 8), (8, 4)
    low, high = DEAD_ZONE_N
    print(f"surge force demanded of the CUBE, whose thrusters make nothing between {low:g} and {high:g} N")
    print("(error: of force and torque together; forces of T1 to T4, T5 to T8 have the same)\n")
    print("              pseudo-inverse, cut off                        exact")
    print("demanded [N]   made   error   forces [N]                     made   error   forces [N]")
    for surge in (1.0, 4.0, 8.0, 16.0, 60.0, 200.0):
        wrench = np.array([surge, 0, 0, 0, 0, 0])
        # A new allocator each time: one that is kept prefers the sides it has chosen before.
        naive = make_allocator("clipped_pseudo_inverse", A, limits).allocate(wrench)
        exact = make_allocator("search", A, limits).allocate(wrench)
        print(f"{surge:12.0f}{described(naive)}{described(exact)}  {exact.status.name}")


def described(answer: Allocation) -> str:
    """Surge force made, norm of the wrench's error, and forces [N], in one line."""
    forces = " ".join(f"{f:6.1f}" for f in answer.force[:4])
    return f"{answer.wrench[0]:8.2f}{answer.residual:7.2f}{forces:>30}"


if __name__ == "__main__":
    main()
