"""The forces of thrusters within their limits that leave least of a wrench, found one by one, again and again."""

from __future__ import annotations

from cube_sim.native.compiled import compiled

THOROUGH = (1000, 1e-6)
"""Sweeps over the thrusters at most, and the share of the largest force by which a sweep that changes less is the
last: where the forces are flown."""
QUICK = (60, 1e-4)
"""The same where thousands of attitudes are compared."""


@compiled
def nearest_forces(matrix, gram, least, most, accuracy, residual, forces):
    """The forces (k,) that leave least of a wrench (6,); both are moved on.

    Args:
        matrix: (6,k), scaled.
        gram: (k,) the square of each column.
        least: (k,) [N].
        most: (k,) [N].
        accuracy: `THOROUGH` or `QUICK`.
        residual: (6,) the wrench, scaled; what is left of it in the end.
        forces: (k,) [N] from where to begin.
    """
    sweeps, fine = accuracy
    largest = 0.0
    for k in range(len(least)):
        largest = max(largest, most[k], -least[k])
    for _ in range(sweeps):
        moved = 0.0
        for k in range(len(least)):
            slope = 0.0
            for i in range(6):
                slope += matrix[i, k] * residual[i]
            change = min(max(forces[k] + slope / gram[k], least[k]), most[k]) - forces[k]
            forces[k] += change
            moved = max(moved, abs(change))
            for i in range(6):
                residual[i] -= matrix[i, k] * change
        if moved < fine * largest:
            break
