"""What an actuation matrix can and cannot do, with all its thrusters and without some (report, sections 4.1, 4.2)."""

from cube_sim.actuation.analysis import Analysis, analyse
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.verdict import Outcome, Verdict
from cube_sim.actuation.survivability import Survivability, survivability

__all__ = ["Analysis", "Outcome", "PathRequirements", "Survivability", "Verdict", "analyse", "survivability"]
