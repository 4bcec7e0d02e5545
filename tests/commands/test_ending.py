"""How the process of a command ends that frees nothing."""

from __future__ import annotations

import subprocess
import sys

import pytest

ENDS = """
import atexit, sys, threading, time
from cube_sim.commands.ending import end_process, leave_untidied
class Freed:
    def __del__(self):
        print("freed")
held = Freed()
atexit.register(print, "heard")
threading.Thread(target=lambda: (time.sleep(0.2), print("waited for"))).start()
print("said", end=" ")
if {untidied}:
    leave_untidied()
end_process({code!r})
print("still here")
"""


def ended(untidied: bool, code: object) -> tuple[int, list[str]]:
    script = ENDS.format(untidied=untidied, code=code)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stderr == ""
    return done.returncode, done.stdout.split("\n")


@pytest.mark.parametrize(("code", "number"), [(0, 0), (None, 0), (3, 3)])
def test_everything_is_waited_for_and_heard_and_nothing_freed(code, number):
    assert ended(True, code) == (number, ["said waited for", "heard", ""])


def test_whoever_has_not_asked_for_it_goes_on():
    assert ended(False, 3) == (0, ["said still here", "waited for", "heard", "freed", ""])
