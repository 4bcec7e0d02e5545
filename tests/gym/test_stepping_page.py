"""The program of docs/stepping.md, run as it stands there."""

import re

import pytest
from support.places import REPO

from cube_sim.gym import FlightEnv

PAGE = (REPO / "docs" / "stepping.md").read_text(encoding="utf-8")


@pytest.mark.flight
def test_the_program_of_the_page_runs(monkeypatch, capsys):
    monkeypatch.chdir(REPO)
    program = "\n".join(re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S))
    names: dict = {}
    exec(compile(program, "stepping.md", "exec"), names)
    assert names["flight"].time_s == pytest.approx((70 + 100) * 0.02)
    assert names["seen"].shape == (2, names["env"].observation_space.shape[0])
    assert len(capsys.readouterr().out.splitlines()) >= 2


def test_the_page_has_the_layout_of_the_code():
    rows = re.findall(r"^\| `(\w+)` \| (\S+(?: k)?) \| (\S+) \| ", PAGE, re.M)
    env = FlightEnv(REPO / "scenarios" / "cube_hover.yaml", ahead_m=(0.0, 0.5, 1.0, 2.0, 4.0))
    counts = {"3 k": 15, "m": 8}
    assert [(name, counts.get(size) or int(size), unit) for name, size, unit in rows] == [
        (part.name, part.size, part.unit) for part in env.layout.parts
    ]
