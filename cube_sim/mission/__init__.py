"""A loaded scenario turned into the objects the loop drives."""

from cube_sim.mission.prepare import Mission, prepare

__all__ = ["Mission", "prepare"]
