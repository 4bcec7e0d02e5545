"""Every example runs as its reader would run it, and prints what it promises."""

import os
import re
import subprocess
import sys

import pytest
from support.places import REPO

NAMES = sorted(file.stem for file in (REPO / "examples").glob("*.py"))


def close(a, b, tolerance):
    return abs(float(a) - float(b)) <= tolerance


def step_the_water(text):
    drag, simulated = re.search(r"drag of 40 N at (\S+) m/s; simulated: (\S+) m/s", text).groups()
    assert close(drag, simulated, 2e-4)


def steer_by_fins(text):
    errors = re.findall(r"(\S+) m aside and (\S+) m off its depth", text)
    assert len(errors) == 3
    assert all(float(aside) < 0.5 and float(depth) < 0.5 for aside, depth in errors)
    assert "survey: leg 5 of 5" in text
    assert float(re.search(r"helix:  (\S+) turns", text)[1]) > 1.5


def randomise_hulls(text):
    rows = re.findall(r"^ +\d .*", text, re.M)
    assert len(rows) == 5
    assert len({row.split()[4] for row in rows}) == 5
    assert float(re.search(r"from equilibrium: (\S+) m/s", text)[1]) < 1e-3


def tether(text):
    assert float(re.search(r"keeps to (\S+) J", text)[1]) < 1e-4
    farthest = max(float(row.split()[1]) for row in re.findall(r"^ +\d\.\d .*", text, re.M))
    assert 1.5 < farthest < 2.5


def read_a_run(text):
    judged = re.search(r"distance across the path, once caught up: (\S+) <=", text)[1]
    assert judged == re.search(r"by our own account: at most (\S+) m", text)[1]
    assert "verdict PASS" in text
    assert re.search(r"\d+ reversals of 8 thrusters in 75 s; \d+ J per metre of way", text)


def allocate_wrenches(text):
    rows = [row.split() for row in re.findall(r"^ +\d+  .*", text, re.M)]
    assert [row[-1] for row in rows] == ["EXACT"] * 5 + ["CLOSEST"]
    for demanded, made, *_ in rows[:3]:
        assert float(made) < float(demanded)
    for row in rows[:5]:
        assert close(row[0], row[7], 0.005)
        assert float(row[8]) == 0.0
    assert float(rows[5][8]) < float(rows[5][2])


def passed(text, first_check, at_most):
    """Both vehicles pass all checks; the value of the first check is at most so much."""
    assert re.findall(r"^(\w+): (\w+),", text, re.M) == [("cube", "PASS"), ("bluerov2_heavy", "PASS")]
    values = re.findall(rf"PASS  {first_check}: (\S+),", text)
    assert len(values) == 2
    assert max(map(float, values)) <= at_most


def own_pid(text):
    passed(text, "cross-track RMS after convergence", 0.05)


def own_pid_compiled(text):
    passed(text, "cross-track RMS after convergence", 0.05)


def own_lqr(text):
    passed(text, "cross-track RMS after convergence", 0.07)


def own_allocator(text):
    passed(text, "cross-track RMS after convergence", 0.02)
    assert all(0.0 < float(share) < 100.0 for share in re.findall(r"(\S+) % of the wrenches exact", text))


def own_allocator_compiled(text):
    own_allocator(text)


def own_path(text):
    passed(text, "max of path_error.cross_track", 0.1)


def own_attitude(text):
    passed(text, "max of path_error.cross_track", 0.05)
    assert all(float(off) < 5.0 for off in re.findall(r"(\S+) deg off the current", text))


def own_guidance(text):
    passed(text, "rms of path_error.cross_track", 0.1)


def own_range(text):
    without, held = (float(number) for number in re.findall(r"off by (\S+) m RMS", text))
    assert held < 0.1 < 0.5 < without


def train_a_law(text):
    earned = [float(number) for number in re.findall(r"^generation +\d+: best +\S+, mean +(\S+) of 20", text, re.M)]
    assert len(earned) == 2
    rows = [row.split("]")[1].split() for row in re.findall(r"^\[.*", text, re.M)]
    assert [row[0] for row in rows] == ["trained", "ours"] * 3
    assert all(row[1] == "PASS" for row in rows if row[0] == "ours")
    assert all(float(number) >= 0.0 for row in rows for number in row[2:])


PROMISED = {
    check.__name__: check
    for check in (
        step_the_water,
        randomise_hulls,
        tether,
        steer_by_fins,
        read_a_run,
        allocate_wrenches,
        own_pid,
        own_pid_compiled,
        own_lqr,
        own_allocator,
        own_allocator_compiled,
        own_path,
        own_attitude,
        own_guidance,
        own_range,
        train_a_law,
    )
}
ARGUMENTS = {"train_a_law": ["--generations", "2", "--laws", "6"]}
"""What is shorter than the reader's run."""


@pytest.mark.flight
@pytest.mark.parametrize("name", NAMES)
def test_example(name, tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(REPO)}
    done = subprocess.run(
        [sys.executable, "-W", "error", REPO / "examples" / f"{name}.py", *ARGUMENTS.get(name, ())],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    PROMISED[name](done.stdout)  # an example of which nothing is asked is not finished
