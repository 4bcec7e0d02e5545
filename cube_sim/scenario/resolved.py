"""A scenario written out in full, defaults included, to be saved beside what it produced."""

from __future__ import annotations

import io
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.representer import RoundTripRepresenter

from .schema import Scenario


class _Representer(RoundTripRepresenter):
    """Writes null where the round-trip default leaves an empty place."""

    def represent_none(self, data: None) -> Any:
        return self.represent_scalar("tag:yaml.org,2002:null", "null")


_Representer.add_representer(type(None), _Representer.represent_none)


def to_yaml(scenario: Scenario) -> str:
    """YAML text that `load` turns into an equal scenario."""
    yaml = YAML(typ="rt", pure=True)
    # No folding: a long description stays one line.
    yaml.width = 2**31
    yaml.Representer = _Representer
    stream = io.StringIO()
    yaml.dump(_nodes(scenario.model_dump(mode="python")), stream)
    return stream.getvalue()


def _nodes(value: Any) -> Any:
    if isinstance(value, dict):
        return CommentedMap((key, _nodes(item)) for key, item in value.items())
    if isinstance(value, list | tuple):
        sequence = CommentedSeq(_nodes(item) for item in value)
        if not any(isinstance(item, dict) for item in value):
            sequence.fa.set_flow_style()
        return sequence
    return value
