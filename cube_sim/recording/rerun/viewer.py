"""The Rerun viewer as a program: its window, or its page in a browser."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import quote

from cube_sim.errors import RecordingError
from cube_sim.uninterrupted import uninterrupted

LOCAL = "127.0.0.1"
"""Where the viewer listens: it would be open to the network otherwise."""


def executable() -> str:
    """The viewer's own binary; its Python wrapper would leave it behind when it is stopped.

    Raises:
        RecordingError: it is not installed.
    """
    spec = find_spec("rerun_cli")
    if spec is None or not spec.submodule_search_locations:
        raise RecordingError("the rerun viewer is not installed")
    name = "rerun.exe" if sys.platform == "win32" else "rerun"
    return str(Path(spec.submodule_search_locations[0]) / name)


def start(arguments: Sequence[str], port: int) -> subprocess.Popen[bytes]:
    """Run the viewer, in silence, listening at a port of this machine alone."""
    return subprocess.Popen(
        [executable(), "--bind", LOCAL, "--port", str(port), *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "TELEMETRY_ENABLED": "false"},
    )


def free_port() -> int:
    """A port nobody listens at."""
    with socket.socket() as probe:
        probe.bind((LOCAL, 0))
        return int(probe.getsockname()[1])


def has_display(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether there is a screen for a window."""
    return not sys.platform.startswith("linux") or any(
        environment.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET")
    )


def open_window(rrd: Path) -> None:
    """Show a recording in a window, until that is closed.

    Raises:
        RecordingError: the viewer is not installed, or ends with an error.
    """
    with _running([str(rrd)], free_port()) as process:
        code = process.wait()
    if code != 0:
        raise RecordingError(
            f"the viewer ended with code {code}; is there a screen and a Vulkan driver? "
            "--web shows the run in a browser"
        )


@contextmanager
def web_viewer(rrd: Path) -> Iterator[WebViewer]:
    """Serve the viewer's page to browsers on this machine; whatever ends the block ends the server.

    Raises:
        RecordingError: the viewer is not installed.
    """
    port, page = free_port(), free_port()
    proxy = quote(f"rerun+http://{LOCAL}:{port}/proxy", safe="")
    with _running(["--serve-web", "--web-viewer-port", str(page), str(rrd)], port) as process:
        yield WebViewer(f"http://{LOCAL}:{page}/?url={proxy}", process)


@dataclass(frozen=True)
class WebViewer:
    """The viewer's page, served.

    Attributes:
        url: to open.
        process: that serves it.
    """

    url: str
    process: subprocess.Popen[bytes]

    def serve(self) -> None:
        """Go on until the server ends.

        Raises:
            RecordingError: the server cannot serve.
        """
        code = self.process.wait()
        if code != 0:
            raise RecordingError(f"the web viewer ended with code {code}")


@contextmanager
def _running(arguments: Sequence[str], port: int) -> Iterator[subprocess.Popen[bytes]]:
    """Run the viewer; whatever ends the block ends it, an interrupt at any moment too."""
    process: subprocess.Popen[bytes] | None = None
    try:
        with uninterrupted():
            process = start(arguments, port)
        yield process
    finally:
        if process is not None and process.poll() is None:
            process.terminate()
            process.wait(timeout=30)
