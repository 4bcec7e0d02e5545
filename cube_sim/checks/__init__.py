"""Checks: pure functions of recorded signals.

A signal is an array (n, 1 + width) named ``channel.field``; column 0 is simulated time [s]. A check first
proves that it can be judged: its signals exist, cover the run, lie inside the window and are finite. What
cannot be judged is an ERROR, never a PASS.
"""

from cube_sim.checks.allowed_forces import distance_to_allowed
from cube_sim.checks.evaluating import Evaluation, SignalsInBlocks, evaluate

__all__ = ["Evaluation", "SignalsInBlocks", "distance_to_allowed", "evaluate"]
