"""How the process of a command ends: nothing is freed, everything is waited for."""

from __future__ import annotations

import subprocess
import sys

import pytest

ENDS = """
import atexit, sys, threading, time
from cube_sim.commands.ending import end_process
class Freed:
    def __del__(self):
        print("freed")
held = Freed()
atexit.register(print, "heard")
threading.Thread(target=lambda: (time.sleep(0.2), print("waited for"))).start()
print("said", end=" ")
end_process({code!r})
print("still here")
"""


@pytest.mark.parametrize("code", [0, 3])
def test_everything_is_waited_for_and_heard_and_nothing_freed(code):
    script = ENDS.format(code=code)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout.split("\n"), done.stderr) == (code, ["said waited for", "heard", ""], "")
