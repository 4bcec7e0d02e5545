"""A loaded scenario turned into the objects the loop drives."""

from cube_sim.mission.channels import PATH_POINTS
from cube_sim.mission.prepare import Mission, prepare

__all__ = ["PATH_POINTS", "Mission", "prepare"]
