"""MuJoCo's warnings as values instead of lines on stderr and in a MUJOCO_LOG.TXT of the working directory."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def collect_warnings() -> Iterator[list[str]]:
    """While this lasts, MuJoCo's warnings go into the list that it yields; the handler is the whole process's."""
    warnings: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)
    try:
        yield warnings
    finally:
        mujoco.set_mju_user_warning(before)
