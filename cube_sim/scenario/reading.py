"""The text of a scenario file read and parsed, and a mistake in it as a line."""

from __future__ import annotations

from pathlib import Path

from cube_sim.errors import ScenarioError
from cube_sim.scenario.document import EMPTY, Document, Location, Mistake, parse

# Far above any scenario; a recording or a table given by mistake is not parsed for minutes.
_LARGEST_BYTES = 1_000_000
SCENARIO, CHECKS = "scenario file", "file of checks"


class NoScenarioError(ScenarioError):
    """What is named is no scenario file at all: it cannot be read, is empty, or holds something else."""


def read_text(path: Path, what: str = SCENARIO) -> str:
    """The text of a file.

    Args:
        path: of it.
        what: it should be, in words.

    Raises:
        NoScenarioError: it cannot be read, or is no such file.
    """
    try:
        # A pipe or a device would be read for ever, or only once.
        if path.exists() and not path.is_file():
            raise NoScenarioError([f"{path}: is {'a folder' if path.is_dir() else 'not a regular file'}, not a {what}"])
        if path.stat().st_size > _LARGEST_BYTES:
            raise NoScenarioError([f"{path}: is larger than {_LARGEST_BYTES} bytes, so it is no {what}"])
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise NoScenarioError([f"{path}: cannot be read: {reason}"]) from error
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        raise NoScenarioError(
            [f"{path}:{line}:{column}: not UTF-8 text (byte 0x{content[error.start]:02x})"]
        ) from error


def parsed(path: Path, text: str, what: str = SCENARIO) -> Document:
    """The document of a text.

    Args:
        path: the text's, for mistakes.
        text: YAML.
        what: it should be, in words.

    Raises:
        ScenarioError: it is no YAML.
        NoScenarioError: it is no block of keys.
    """
    document = parse(text)
    if document.data is None:
        error = NoScenarioError if any(mistake.message == EMPTY for mistake in document.mistakes) else ScenarioError
        raise error([line(path, mistake) for mistake in document.mistakes])
    if not isinstance(document.data, dict):
        inside = " with checks: in it" if what == CHECKS else ""
        held = type(document.data).__name__
        raise NoScenarioError(
            [f"{path}:1:1: a {what.removesuffix(' file')} is a block of keys{inside}, this file holds a {held}"]
        )
    return document


def line(path: Path, mistake: Mistake) -> str:
    """A mistake in words, with its place: in the file at `path`, unless its position says another."""
    if mistake.position is None:
        return mistake.message
    place = f"{mistake.position.file or path}:{mistake.position.line}:{mistake.position.column}"
    return ": ".join(part for part in (place, dotted(mistake.location), mistake.message) if part)


def dotted(location: Location) -> str:
    """A location as a path with dots."""
    return ".".join(map(str, location))
