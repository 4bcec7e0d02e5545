"""What is wrong with the first line of a CSV file, in the words of an error."""

from __future__ import annotations

from collections.abc import Sequence


def wrong_columns(cells: Sequence[str], columns: Sequence[str]) -> str | None:
    """Which columns are missing, unknown or at other places; None where they are those that are right.

    Args:
        cells: of the first line, taken apart at commas.
        columns: that are right, in their order.
    """
    if list(cells) == list(columns):
        return None
    right = f"{','.join(columns)} is right"
    for separator, called in ((";", "semicolons"), ("\t", "tabs")):
        if len(cells) == 1 and separator in cells[0]:
            return f"the first line is separated by {called}; commas are right, and points in numbers: {right}"
    said = []
    if missing := [each for each in columns if each not in cells]:
        said.append(f"lacks {', '.join(missing)}")
    if unknown := [each or "an empty one" for each in cells if each not in columns]:
        said.append(f"has {', '.join(unknown)}, which {'is' if len(unknown) == 1 else 'are'} not known")
    return f"the first line {' and '.join(said) or 'has the columns in another order, or twice'}; {right}"
