"""Wrench to thruster forces: the exact dead-zone allocation of the report's section 4.3.

The names are loaded on first use, because the compiled search and ProxQP take a moment to import.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cube_sim.allocation.allocation import Allocation, Status
    from cube_sim.allocation.allocator import Allocator
    from cube_sim.allocation.fault_tolerant import FaultTolerant
    from cube_sim.allocation.methods import make_allocator
    from cube_sim.wrench.health import Health

__all__ = ["Allocation", "Allocator", "FaultTolerant", "Health", "Status", "make_allocator"]

_HOME = {
    "Allocation": "cube_sim.allocation.allocation",
    "Allocator": "cube_sim.allocation.allocator",
    "FaultTolerant": "cube_sim.allocation.fault_tolerant",
    "Health": "cube_sim.wrench.health",
    "Status": "cube_sim.allocation.allocation",
    "make_allocator": "cube_sim.allocation.methods",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
