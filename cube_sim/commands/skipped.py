"""What is said of the YAML files of a folder that are no scenarios."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

MOST_NAMED = 5


def said_of_others(others: Sequence[Path]) -> list[str]:
    """One line; none where there are no such files.

    Args:
        others: the files.
    """
    if not others:
        return []
    named = ", ".join(map(str, others[:MOST_NAMED]))
    more = f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else ""
    return [f"skipped, they hold no scenario: {named}{more}"]
