"""Compiling large functions in another process, beside what this one compiles: the compiler itself takes one core."""

from __future__ import annotations

import os
import subprocess
import sys

_running: dict[str, subprocess.Popen[bytes]] = {}


def begin(*functions: str) -> None:
    """Let another process call functions, one after the other, which leave their machine code on disk.

    Nothing depends on it: what it does not leave behind is compiled here.

    Args:
        functions: "module:name" each, without arguments.
    """
    if functions[0] in _running or (os.cpu_count() or 1) < 2:
        return
    parts = [function.split(":") for function in functions]
    command = [sys.executable, "-c", "\n".join(f"from {module} import {name}; {name}()" for module, name in parts)]
    silent = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        process = subprocess.Popen(command, **silent)  # type: ignore[call-overload]
    except OSError:
        return
    _running.update(dict.fromkeys(functions, process))


def finish(function: str) -> None:
    """Wait until the other process has come to its end, if there is one."""
    if function in _running:
        _running.pop(function).wait()
