"""MuJoCo's warnings as values instead of lines on stderr and in a MUJOCO_LOG.TXT of the working directory."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import mujoco

_here = threading.local()
_lock = threading.Lock()
_users: list[int] = [0]
_before: list[Any] = [None]


@contextmanager
def collect_warnings() -> Iterator[list[str]]:
    """While this lasts, MuJoCo's warnings of this thread go into the list that it yields.

    The handler is the whole process's. Those of a thread that collects none go where they went before.
    """
    warnings: list[str] = []
    outer = getattr(_here, "warnings", None)
    with _lock:
        if _users[0] == 0:
            _before[0] = mujoco.get_mju_user_warning()
            mujoco.set_mju_user_warning(_deliver)
        _users[0] += 1
    _here.warnings = warnings
    try:
        yield warnings
    finally:
        _here.warnings = outer
        with _lock:
            _users[0] -= 1
            if _users[0] == 0:
                mujoco.set_mju_user_warning(_before[0])


def _deliver(message: str) -> None:
    """Called by MuJoCo, in the thread that steps it."""
    warnings = getattr(_here, "warnings", None)
    if warnings is not None:
        warnings.append(message)
    elif _before[0] is not None:
        _before[0](message)
