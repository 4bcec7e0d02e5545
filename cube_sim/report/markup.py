"""Text and elements of the page: all that comes from files passes `text` on its way in."""

from __future__ import annotations

import html
import math
import re

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What neither XML nor HTML may hold, not even escaped."""


def text(value: object) -> str:
    """The value as text of the page, safe between tags and inside quotes."""
    return html.escape(_NOT_XML.sub("\ufffd", str(value)))


def element(tag: str, content: str = "", **attributes: object) -> str:
    """One element.

    Args:
        tag: its name.
        content: markup inside, escaped already; without any the element closes itself.
        attributes: by name, `class_` for class, `_` for a hyphen; None leaves one out.
    """
    given = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{text(value)}"'
        for name, value in attributes.items()
        if value is not None
    )
    return f"<{tag}{given}>{content}</{tag}>" if content or tag in _NEVER_EMPTY else f"<{tag}{given}/>"


_NEVER_EMPTY = ("div", "span", "td", "th", "table", "script", "style", "p", "g", "section")
"""HTML reads a self-closing one of these as an opening tag."""


def number(value: float | None, digits: int = 4) -> str:
    """A number for readers, with a true minus; a dash where there is none."""
    if value is None or math.isnan(value):
        return "–"
    shown = f"{value:.{digits}g}"
    return "0" if shown == "-0" else shown.replace("-", "−") if "e" not in shown else _power(shown)


def _power(shown: str) -> str:
    mantissa, _, exponent = shown.partition("e")
    return f"{mantissa}e{int(exponent)}".replace("-", "−")


def seconds(value: float) -> str:
    """A time for readers: to the control period, without needless zeros."""
    return f"{value:.2f}".rstrip("0").rstrip(".") + " s"
