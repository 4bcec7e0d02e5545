"""A loaded scenario turned into the objects the loop drives."""

from cube_sim.mission.prepare import PATH_POINTS, Mission, prepare

__all__ = ["PATH_POINTS", "Mission", "prepare"]
