"""Scenario files: the format, and reading it with every mistake named by line and column."""

from .loading import Loaded, load
from .schema import Scenario

__all__ = ["Loaded", "Scenario", "load"]
