"""Scenario files: the format, and reading it with every mistake named by line and column."""

from cube_sim.scenario.loading import Loaded, load, load_mapping
from cube_sim.scenario.schema import Scenario

__all__ = ["Loaded", "Scenario", "load", "load_mapping"]
