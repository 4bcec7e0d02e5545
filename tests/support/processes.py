"""Programs in a process of their own: what they print."""

from __future__ import annotations

import subprocess
import sys


def printed_by(program: str, *arguments: object, environment: dict[str, str] | None = None) -> str:
    """What a Python program writes to stdout; what it writes to stderr is shown if it fails."""
    command = [sys.executable, "-c", program, *map(str, arguments)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
