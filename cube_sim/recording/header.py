"""What a recording says about itself before its first row: enough to run it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256

SOURCE, COMMIT = "cube-sim source", "cube-sim commit"
"""Among the versions: the SHA-256 of the program's own source; its commit, where it ran from a checkout."""


@dataclass(frozen=True)
class RecordedCode:
    """Code of the user's own.

    Attributes:
        key: dotted path of the scenario's value in whose place it stands.
        name: file.py:name or package.module:name.
        source: text of its file; "" where there is none.
    """

    key: str
    name: str
    source: str

    @property
    def digest(self) -> str:
        """SHA-256 of the source, hexadecimal."""
        return sha256(self.source.encode()).hexdigest()

    @property
    def file(self) -> str:
        """Where a recording keeps the source: its key, and the name of its file."""
        place = self.name.rpartition(":")[0]
        name = place if place.endswith(".py") else f"{place.rpartition('.')[2]}.py"
        return f"{self.key}/{name}"


@dataclass(frozen=True)
class RunHeader:
    """The inputs of a run.

    Attributes:
        scenario: text of the scenario file as it was written.
        resolved: the same scenario with every default spelled out, YAML text.
        model: name of the MJCF among the inputs.
        inputs: contents of each file that `resolved` names but for Python, and of those these refer to, by name.
        code: code of the user's own that took part.
        versions: of each package that takes part in the numbers, and what else does: `SOURCE`, the processor ...
        seed: seed of the run's random numbers.
        vehicles: of several vehicles, the body of each in the model of its own file, by its name; empty of one.
    """

    scenario: str
    resolved: str
    model: str
    inputs: Mapping[str, bytes]
    code: tuple[RecordedCode, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0
    vehicles: Mapping[str, str] = field(default_factory=dict)

    @property
    def build(self) -> str:
        """Which code of cube_sim flew: the start of the SHA-256 of its source, and its commit where that is known."""
        source, commit = self.versions.get(SOURCE, ""), self.versions.get(COMMIT, "")
        at = f" (commit {commit[:12]}{commit[40:]})" if commit else ""
        return f"source {source[:12]}{at}" if source else "not recorded"

    @property
    def mjcf(self) -> str:
        """Text of the MJCF; what is no UTF-8 in it is replaced."""
        return self.inputs[self.model].decode(errors="replace")
