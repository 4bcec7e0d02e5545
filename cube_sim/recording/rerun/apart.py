"""The view, drawn by a process of its own: to import Rerun takes as long as to fly two minutes.

Whoever is about to fly once says so by `begin`, and loads what flying takes while the other process loads Rerun.
Nothing depends on it: where it does not come up, the view is drawn here; where it stands still, it is given up.
"""

from __future__ import annotations

import atexit
import os
import pickle
import select
import signal
import subprocess
import sys
from contextlib import suppress
from typing import IO, TYPE_CHECKING, Any

from cube_sim.native.heap import seldom_look_for_circles
from cube_sim.recording.rerun import patience as waiting
from cube_sim.recording.rerun.patience import Patience, StalledError

if TYPE_CHECKING:
    from cube_sim.recording.batch import Batch, View
    from cube_sim.recording.run_end import RunEnd

_READY = b"ready\n"
_KILLED_S = 1.0
_waiting: list[subprocess.Popen[bytes]] = []


def begin() -> None:
    """Start a process that gets ready for the next view of this one."""
    if _waiting or (os.cpu_count() or 1) < 2 or not sys.executable or not hasattr(select, "poll"):
        return
    command = [sys.executable, "-c", f"from {__name__} import serve; serve()"]
    # It draws with one thread, opens no window, and what it has to say it says by its answer.
    surroundings = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MUJOCO_GL": "disable", "RUST_LOG": "off"}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    try:
        # In a session of its own: Ctrl-C and the end of a terminal are for who flies, and brings the view to its end.
        process = subprocess.Popen(command, env=surroundings, start_new_session=True, bufsize=0, **pipes)  # type: ignore[call-overload]
    except OSError:
        return
    _waiting.append(process)
    atexit.register(_let_go)


def is_begun() -> bool:
    """Whether a process gets ready, or is, for a view that nobody has asked for yet."""
    return bool(_waiting)


def view_apart(patience: Patience, *arguments: Any) -> View | None:
    """A view written by the process that has been begun; None where there is none.

    Args:
        patience: how long that process is waited for.
        arguments: of `cube_sim.recording.rerun.sink.rerun_sink`.
    """
    if not _waiting:
        return None
    process = _waiting.pop()
    try:
        content = pickle.dumps(arguments)
        assert process.stdin is not None
        assert process.stdout is not None
        os.set_blocking(process.stdin.fileno(), False)
        if patience.received(process.stdout.fileno(), waiting.TAKES_S, len(_READY)) != _READY:
            raise EOFError
        patience.send(process.stdin.fileno(), content)
    except Exception:  # it has not come up, or the model is of a kind that cannot be told
        _end(process)
        return None
    return _ViewApart(process, process.stdin, process.stdout, patience)


class _ViewApart:
    """Hands everything on to the process that draws."""

    def __init__(self, process: subprocess.Popen[bytes], to: IO[bytes], answers: IO[bytes], patience: Patience) -> None:
        self._process, self._to, self._answers, self._patience = process, to, answers, patience
        self._stalled: StalledError | None = None

    def write(self, batch: Batch) -> None:
        """Hand the next batch on."""
        self._call("write", batch)

    def tell(self, end: RunEnd) -> None:
        """Let it show how the run ended."""
        self._call("tell", end)

    def close(self) -> None:
        """Wait until the view is written.

        Raises:
            RuntimeError: it is not, and why.
        """
        self._call("close")
        self._to.close()
        try:
            answer = self._patience.received(self._answers.fileno(), waiting.ENDS_S)
        except StalledError as error:
            self._give_up(error)
            raise
        try:
            failure = pickle.loads(answer)
        except (EOFError, pickle.UnpicklingError):
            failure = ""
        try:
            code = self._process.wait(waiting.TAKES_S)  # it has closed its end of the pipe: it ends, or has
        except subprocess.TimeoutExpired:
            _end(self._process)
            raise RuntimeError("the process that draws it does not end") from None
        if code:
            raise RuntimeError(failure or f"the process that draws it ended with code {code}")

    def _call(self, name: str, *arguments: Any) -> None:
        if self._stalled is not None:
            raise self._stalled
        try:
            self._patience.send(self._to.fileno(), pickle.dumps((name, arguments)))
        except BrokenPipeError:  # what became of it is told at the end
            pass
        except StalledError as error:
            self._give_up(error)
            raise

    def _give_up(self, error: StalledError) -> None:
        self._stalled = error
        _end(self._process)


def serve() -> None:
    """In the other process: draw what is handed on, until it is said to be all or nobody is there any more."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    given, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.meta_path.insert(0, _WithoutPandas)
    seldom_look_for_circles()
    from cube_sim.recording.rerun.sink import rerun_sink

    answers.write(_READY)
    answers.flush()
    try:
        arguments = pickle.load(given)
    except EOFError:
        return
    failure = _drawn(given, rerun_sink, arguments)
    pickle.dump(failure, answers)
    answers.flush()
    os._exit(1 if failure else 0)


class _WithoutPandas:
    """pyarrow would import it to see whether an array is one of its, which takes half a second; there are none here."""

    @staticmethod
    def find_spec(name: str, *_: Any) -> None:
        """Refuse it, as where it is not installed."""
        if name == "pandas":
            raise ModuleNotFoundError(name, name=name)


def _drawn(given: IO[bytes], make: Any, arguments: tuple[Any, ...]) -> str:
    """Why the view could not be drawn, in one line; "" where it was."""
    try:
        sink = make(*arguments)
    except Exception as error:
        return _said(error)
    failure = ""
    while True:
        try:
            name, told = pickle.load(given)
        except (EOFError, pickle.UnpicklingError):  # whoever flew is gone
            name, told = "close", ()
        try:
            if not failure or name == "close":
                getattr(sink, name)(*told)
        except Exception as error:
            failure = failure or _said(error)
        if name == "close":
            return failure


def _end(process: subprocess.Popen[bytes]) -> None:
    """End it now; what hangs at a disk is left to the system."""
    process.kill()
    with suppress(subprocess.TimeoutExpired):
        process.wait(_KILLED_S)


def _said(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _let_go() -> None:
    """At the end of this process: nobody has wanted the view."""
    while _waiting:
        _waiting.pop().kill()
