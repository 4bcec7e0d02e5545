"""What a recording says about itself before its first row: enough to run it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class RunHeader:
    """The inputs of a run.

    Attributes:
        scenario: text of the scenario file as it was written.
        resolved: the same scenario with every default spelled out, YAML text.
        mjcf: text of the MJCF model.
        assets: contents of the files the MJCF refers to, by the name it uses.
        versions: version of each package that takes part in the numbers.
        seed: seed of the run's random numbers.
    """

    scenario: str
    resolved: str
    mjcf: str
    assets: Mapping[str, bytes] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0
