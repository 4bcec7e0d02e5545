"""What can be chosen of an allocation, by name: read by allocators, and by scenarios without loading any of them."""

from __future__ import annotations

from typing import Literal

Method = Literal["search+proxqp", "search", "enumerate", "enumerate_parallel"]
"""The exact methods.

``search+proxqp``: the exact search decides the subset, ProxQP solves it and must agree. ``search``: without ProxQP.
``enumerate``: the report's own algorithm, one ProxQP for each of the 2^m or 3^m subsets. ``enumerate_parallel``: the
same spread over the processor's cores.
"""

BaselineMethod = Literal["contraction", "compensation", "pseudo_inverse", "clipped_pseudo_inverse"]
"""Methods that try their best: the two strategies of Ropars et al. (2018) and the two everybody knows."""

Objective = Literal["energy", "target", "reactivity", "reactivity_by_side"]
"""What decides among the forces that make a wrench.

``energy``: least ``sum w f^2``, equation (7) of the report. ``target``: closest to a given F_opt (11). ``reactivity``:
closest to F_react+ of all thrusters or to F_react- of all thrusters, whichever is closer (10). ``reactivity_by_side``:
each thruster close to the reactivity point of the side it works on, a thruster at rest to zero; what (10) is after,
without turning all thrusters round together.
"""

Unattainable = Literal["closest", "scaled"]
"""``closest``: the closest attainable wrench in the weighted norm. ``scaled``: the largest attainable part of the
demand in its own direction, and the closest wrench where nothing is left of it."""

WEIGHTS_SPAN = 1e6
"""Largest ratio of two weights, and their distance from 1: beyond it, what light ones cost is lost in the rounding of
heavy ones."""
