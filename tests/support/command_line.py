"""The command line as tests call it: in a process of its own, or in this one."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from cube_sim.commands.progress import COMPILES


def cube_sim(*arguments, cwd, **options) -> subprocess.CompletedProcess[str]:
    """Call it as a shell does."""
    command = [sys.executable, "-m", "cube_sim", *map(str, arguments)]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, **options)
    done.stderr = without_compiling(done.stderr)
    return done


def without_compiling(err: str) -> str:
    """What is said on stderr, but for the line that depends on whether anything has been compiled before."""
    return err.replace(f"{COMPILES}\n", "")


def interruptible() -> None:
    """Put Ctrl-C back: what a job in the background starts would not hear of it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextmanager
def started(*arguments, cwd) -> Iterator[subprocess.Popen[str]]:
    """Start it as a shell does, to be interrupted; it is gone when the block ends."""
    command = [sys.executable, "-m", "cube_sim", *map(str, arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=cwd, text=True, preexec_fn=interruptible, **pipes) as process:
        try:
            yield process
        finally:
            process.kill()


def call(monkeypatch, capsys, *arguments) -> tuple[int, str, str]:
    """Call the same entry in this process, where the simulation is loaded once for many calls.

    Returns:
        Exit code, stdout, stderr.
    """
    from cube_sim.commands import cli

    monkeypatch.setattr(cli, "end_process", lambda code: None)  # this process is not the command's to end
    monkeypatch.setattr(sys, "argv", ["cube-sim", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    captured = capsys.readouterr()
    return ended.value.code, captured.out, without_compiling(captured.err)
