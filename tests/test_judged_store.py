"""A run of which only the verdict is wanted: judged as it flies, in the same memory however long it is."""

import subprocess
import sys
from pathlib import Path

import pytest

import cube_sim

HELIX = Path(__file__).parents[1] / "scenarios" / "cube_helix.yaml"
MORE_BYTES = 60_000_000
"""Between what the longer run takes more when its rows are kept, some 170 MB, and when not, next to nothing."""
LONGER = """
import sys
import cube_sim

def most_after(duration_s):
    kept = sys.argv[3] == "kept"
    cube_sim.run(sys.argv[1], {"duration_s": duration_s}, sys.argv[2], record="none", keep_signals=kept)
    with open("/proc/self/status") as status:  # getrusage begins with what the parent had
        return 1024 * next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))

first = most_after(150.0)
print(most_after(1200.0) - first)
"""


@pytest.mark.flight
def test_checks_judged_as_it_flies_say_the_same_to_the_bit(tmp_path):
    longer = {"duration_s": 140.0}
    kept = cube_sim.run(HELIX, longer, tmp_path / "kept", record="none")
    judged = cube_sim.run(HELIX, longer, tmp_path / "judged", record="none", keep_signals=False)
    assert len(judged.checks) == 4
    assert judged.checks == kept.checks
    assert judged.verdict == kept.verdict == "PASS"
    assert kept.signals
    assert not judged.signals


@pytest.mark.flight
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the largest memory is told in KiB on Linux")
def test_a_run_of_which_nothing_is_kept_takes_no_more_memory_the_longer_it_is(tmp_path):
    cube_sim.run(HELIX, {"duration_s": 60.0}, tmp_path / "first", record="none")  # compiling takes memory as well
    more = {}
    for kept in ("judged", "kept"):
        command = [sys.executable, "-c", LONGER, HELIX, tmp_path / kept, kept]
        more[kept] = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert more["judged"] < MORE_BYTES < more["kept"]
