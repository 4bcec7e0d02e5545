"""What the law for all axes remembers of what it asked for."""

from __future__ import annotations

import numpy as np

MEMORY = np.dtype(
    [
        ("force", np.float64, 3),
        ("velocity", np.float64, 3),
        ("torque", np.float64, 3),
        ("asked", np.float64, 6),
        ("has_asked", np.bool_),
    ]
)
"""What the law remembers: the force [N] (world axes) and torque [N m] (body axes) an attitude may point, the velocity
asked for [m/s] (world axes) and the wrench asked of the thrusters [N, N m] (body axes)."""
