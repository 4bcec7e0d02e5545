"""Why a check cannot be judged."""

from __future__ import annotations


class NotJudgedError(Exception):
    """A check cannot be judged; the text says why."""


class Reasons:
    """What speaks against judging at all, found block by block: the first of each kind counts."""

    def __init__(self) -> None:
        self._found: dict[str, str] = {}

    def note(self, kind: str, text: str) -> None:
        """Keep a reason, unless there is one of its kind."""
        self._found.setdefault(kind, text)

    def none(self, kind: str) -> bool:
        """Whether there is none of a kind."""
        return kind not in self._found

    def require_none(self, kind: str) -> None:
        """Go on if there is none of a kind.

        Raises:
            NotJudgedError: there is.
        """
        if kind in self._found:
            raise NotJudgedError(self._found[kind])
