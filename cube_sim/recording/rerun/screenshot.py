"""A picture of a recording, taken by the real viewer without a screen.

Needs a Vulkan driver; on a machine without a GPU a software one will do (Debian: mesa-vulkan-drivers).
Pictures of one recording at one instant are alike to the pixel, but for the strip of the time line.
"""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from PIL import Image

from cube_sim.errors import RecordingError
from cube_sim.recording.rerun.drawing import TIMELINE
from cube_sim.recording.rerun.viewer import LOCAL, free_port, start

_MENU_BAR = 36  # pixels
_NOTICE_S = 10.0  # for so long the viewer shows a notice that it has no screen
_STARTUP_S, _LOADING_S, _SETTLING_S = 60.0, 120.0, 120.0


def screenshot(
    rrd: Path, png: Path, t: float, size: tuple[int, int] = (1600, 900), menu_bar: bool = False
) -> list[str]:
    """Open a recording in a viewer, go to an instant and save what is seen.

    Args:
        rrd: the recording.
        png: file to write.
        t: simulated time [s].
        size: width and height of the window [pixels].
        menu_bar: whether the picture keeps the viewer's menu bar, which speaks of the machine, not of the run.

    Returns:
        What the viewer complains about, one line per complaint; empty when all views are well.

    Raises:
        RecordingError: the viewer does not start or does not come to rest.
    """
    from rerun.experimental import ViewerClient

    started = time.monotonic()
    with _viewer(size) as (port, process):
        client = _connect(ViewerClient, port, process)
        client.open(str(rrd.resolve()))
        _wait(lambda: not client.get_state().loading, _LOADING_S, f"the viewer did not load {rrd}")
        client.set_time(TIMELINE, duration=t, play_state="paused")
        time.sleep(max(0.0, started + _NOTICE_S - time.monotonic()))
        picture = Image.open(BytesIO(_settled(client)))
        picture.crop((0, 0 if menu_bar else _MENU_BAR, *picture.size)).save(png, optimize=True)
        state = client.get_state()
        return [f"{view.name}: {report}" for view in state.views for report in view.reports]


@contextmanager
def _viewer(size: tuple[int, int]) -> Iterator[tuple[int, subprocess.Popen[bytes]]]:
    """Run the viewer without a window."""
    port = free_port()
    process = start(["--headless", "--window-size", f"{size[0]}x{size[1]}", "--hide-welcome-screen"], port)
    try:
        yield port, process
    finally:
        process.terminate()
        process.wait(timeout=30)


def _connect(client_class: type, port: int, process: subprocess.Popen[bytes]):
    deadline = time.monotonic() + _STARTUP_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise RecordingError(f"the viewer ended with code {process.returncode}; is there a Vulkan driver?")
        try:
            client = client_class.connect(f"rerun+http://{LOCAL}:{port}/proxy")
            client.get_state()
        except Exception:
            time.sleep(0.5)
        else:
            return client
    raise RecordingError(f"the viewer did not answer within {_STARTUP_S:g} s")


def _settled(client) -> bytes:
    """Take pictures until two in a row are equal."""
    previous = b""
    picture = [client.take_screenshot()]

    def at_rest() -> bool:
        nonlocal previous
        previous, picture[0] = picture[0], client.take_screenshot()
        return picture[0] == previous

    _wait(at_rest, _SETTLING_S, "the picture does not come to rest")
    return picture[0]


def _wait(done: Callable[[], bool], limit_s: float, complaint: str) -> None:
    deadline = time.monotonic() + limit_s
    while not done():
        if time.monotonic() > deadline:
            raise RecordingError(f"{complaint} within {limit_s:g} s")
        time.sleep(0.3)
