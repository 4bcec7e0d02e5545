"""Pieces of Markdown as GitHub reads it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; a bar inside a cell is escaped, a line break becomes a space."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines)


def heading(level: int, text: str) -> str:
    """A heading of level 1, 2, 3 ..."""
    return f"{'#' * level} {text}"


def link(text: str, to_heading: str) -> str:
    """A link to a heading of the same page."""
    return f"[{text}](#{anchor(to_heading)})"


def anchor(heading_text: str) -> str:
    """The name by which a page's heading is linked to."""
    return re.sub(r"[^\w\- ]", "", heading_text.lower()).replace(" ", "-")


def code(text: object) -> str:
    """Text as it is typed."""
    return f"`{text}`"


def block(text: str, language: str = "yaml") -> str:
    """Lines of a file."""
    return f"```{language}\n{text.strip()}\n```"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
