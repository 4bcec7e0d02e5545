"""What all tables of the page are made of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cube_sim.report import colours
from cube_sim.report.markup import element, text
from cube_sim.report.subject import Subject


def table(header: Sequence[str], rows: Iterable[Sequence[str]], kinds: str, *, narrow: bool = False) -> str:
    """A table of cells that are markup already.

    Args:
        header: of each column, plain text.
        rows: of cells.
        kinds: a letter for each column: r a number, s a word that does not break, w text that may break anywhere,
            k the same, with room in any case.
        narrow: as wide as its content only.
    """
    head = "".join(element("th", text(cell), class_=kind) for cell, kind in zip(header, kinds, strict=True))
    body = "".join(
        element("tr", "".join(element("td", cell, class_=kind) for cell, kind in zip(row, kinds, strict=True)))
        for row in rows
    )
    content = f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return element("table", content, class_="narrow" if narrow else None)


def badge(verdict: str) -> str:
    """A verdict to be seen from afar."""
    return element("span", text(verdict), class_="verdict", style=f"background:{colours.of_verdict(verdict)}")


def name_of(subject: Subject) -> str:
    """The label of a run in its colour."""
    return f'<b style="color:{subject.colour}">{text(subject.label)}</b>'
