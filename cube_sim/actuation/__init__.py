"""What an actuation matrix can and cannot do, with all its thrusters and without some (report, sections 4.1, 4.2)."""

from cube_sim.actuation.analysis import Analysis, analyse
from cube_sim.actuation.hull import Hull
from cube_sim.actuation.losses import Survivability, survivability
from cube_sim.actuation.verdict import Mission, Outcome, Verdict

__all__ = ["Analysis", "Hull", "Mission", "Outcome", "Survivability", "Verdict", "analyse", "survivability"]
