"""Results that are there whole or not at all, whatever becomes of the disk meanwhile."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


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
    part = file.with_name(f".{file.stem}.part{file.suffix}")
    try:
        yield part
        part.replace(file)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


@contextmanager
def filled_whole(folder: Path) -> Iterator[None]:
    """Fill a folder that is new or empty; what fails leaves it as it was.

    Args:
        folder: made where there is none, with those above it.

    Raises:
        OSError: it cannot be made.
    """
    made = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        for each in folder.iterdir():
            with suppress(OSError):
                if each.is_dir():
                    shutil.rmtree(each)
                else:
                    each.unlink()
        with suppress(OSError):
            if made:
                folder.rmdir()
        raise
