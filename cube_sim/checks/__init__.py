"""Checks: pure functions of recorded signals.

A signal is an array (n, 1 + width) named ``channel.field``; column 0 is simulated time [s]. A check first
proves that it can be judged: its signals exist, cover the run, lie inside the window and are finite. What
cannot be judged is an ERROR, never a PASS.
"""

from cube_sim.checks.allowed_forces import distance_to_allowed
from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.condition import margin_of
from cube_sim.checks.evaluating import Evaluation, SignalsInBlocks, evaluate
from cube_sim.checks.measured import series_of

__all__ = [
    "Beforehand",
    "Evaluation",
    "SignalsInBlocks",
    "distance_to_allowed",
    "evaluate",
    "margin_of",
    "series_of",
]
