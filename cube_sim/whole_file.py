"""Results that are there whole or not at all, whatever becomes of the disk meanwhile."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from errno import ENOENT
from pathlib import Path

_unfinished: list[Callable[[], None]] = []


def undo_unfinished() -> None:
    """Undo what is half written: for a process that ends at once, and passes no block on its way."""
    for undo in reversed(_unfinished):
        undo()


@contextmanager
def undone_if_left(undo: Callable[[], None]) -> Iterator[None]:
    """Let something be undone where a block raises, or the process ends amid it by `undo_unfinished`."""
    _unfinished.append(undo)
    try:
        yield
    except BaseException:
        undo()
        raise
    finally:
        _unfinished.remove(undo)


def part_of(file: Path) -> Path:
    """Where a file is written before it is whole: in its folder, of the same suffix."""
    return file.with_name(f".{file.stem}.part{file.suffix}")


@contextmanager
def written_whole(file: Path) -> Iterator[Path]:
    """Write a file beside its place, and put it there once it is whole: an earlier one stays until then.

    What is no usual file, as /dev/stdout, is written where it is.

    Args:
        file: where it goes.

    Yields:
        What to write, of the same suffix.

    Raises:
        OSError: it cannot be put there.
    """
    if file.exists() and not file.is_file():
        yield file
        return
    file = file.resolve() if file.is_symlink() else file
    if not file.parent.exists():
        raise FileNotFoundError(ENOENT, f"there is no folder {file.parent}")
    part = part_of(file)
    with undone_if_left(lambda: _remove(part)):
        yield part
        part.replace(file)


@contextmanager
def filled_whole(folder: Path) -> Iterator[None]:
    """Fill a folder that is new or empty; what fails leaves it as it was.

    Args:
        folder: made where there is none, with those above it.

    Raises:
        OSError: it cannot be made.
    """
    made = not folder.exists()
    with undone_if_left(lambda: _empty(folder, made)):
        folder.mkdir(parents=True, exist_ok=True)
        yield


def _empty(folder: Path, made: bool) -> None:
    with suppress(OSError):
        for each in folder.iterdir():
            _remove(each)
        if made:
            folder.rmdir()


def _remove(place: Path) -> None:
    with suppress(OSError):
        if place.is_dir():
            shutil.rmtree(place)
        else:
            place.unlink(missing_ok=True)
