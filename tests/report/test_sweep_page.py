"""The page of a sweep: well formed, alone, the same every time, and its commands work."""

from __future__ import annotations

import json
import re
import shlex
import xml.etree.ElementTree as ET

import pytest
from support.command_line import call, cube_sim
from support.scenario_files import FLIGHT
from support.sweeps import SAMPLES, rows_of, swept, written

from cube_sim.campaign.folder import Shard
from cube_sim.campaign.result import load_sweep
from cube_sim.campaign.sweep import sweep
from cube_sim.report.sweep_page import sweep_report
from cube_sim.scenario import load

pytestmark = pytest.mark.flight


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("it's flown")
    file = written(folder, SAMPLES.replace("count: 12", "count: 40"))
    return file, swept(file, folder / "out & about", keep="failures")


@pytest.fixture(scope="module")
def page(flown):
    return sweep_report(load_sweep([flown[1].folder]))


def parsed(page):
    assert page.startswith("<!DOCTYPE html>\n")
    return ET.fromstring(page.partition("\n")[2])


def test_it_is_well_formed_and_says_what_the_rows_say(flown, page):
    _, result = flown
    root = parsed(page)
    sections = [section.get("id") for section in root.iter("section")]
    assert sections == ["rate", "checks", "values", "influence", "worst", "map", "statistics"]
    said = " ".join(" ".join(root.find("body").itertext()).split())
    passed, failed = result.count("PASS"), result.count("FAIL")
    assert f"{passed} of 40 samples pass, all of them wanted" in said
    assert f"{100 * passed / 40:.2f} %" in said
    points = list(root.iter("circle"))
    assert len(points) == 40
    titles = [each.find("title").text for each in points]
    assert sum(": FAIL" in title for title in titles) == failed > 0


def test_it_needs_nothing_beside_it_and_is_the_same_every_time(flown, page):
    assert not re.search(r"https?:|\bfile:|@import|url\((?!#)|//[a-z]", page)
    assert sweep_report(load_sweep([flown[1].folder])) == page


def test_the_command_of_the_worst_sample_flies_it_again(flown, page, tmp_path):
    _, result = flown
    codes = [code.text for code in parsed(page).iter("code")]
    command, recorded = codes[0], codes[1]
    done = cube_sim(*shlex.split(command)[1:], "--record", "none", "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    k = int(shlex.split(command)[shlex.split(command).index("--sample") + 1])
    row = rows_of(result.folder)[k]
    assert json.loads(done.stdout)["checks"][0]["value"] == row["check.max of path_error.cross_track.value"]
    assert row["verdict"] == "FAIL"
    assert recorded == str(result.folder / "runs" / str(k))


def test_settings_are_part_of_the_command(tmp_path):
    file = written(tmp_path)
    settings = {
        "samples.count": 2,
        "description": "it's 5 % more",
        "current_m_s": [0.1, 0, 0],
        "control.cost_limit": None,
    }
    result = sweep(load(file, settings), tmp_path / "out")
    words = shlex.split(result.command(1))
    done = cube_sim(*words[1:], "--record", "none", "--out", "again", cwd=tmp_path)
    assert done.returncode in (0, 1), done.stderr
    resolved = (tmp_path / "again" / "resolved.yaml").read_text()
    assert "it's 5 % more" in resolved
    assert "current_m_s: [0.1, 0.0, 0.0]" in resolved


def test_parts_of_a_sweep_are_one_page(tmp_path, monkeypatch, capsys):
    file = written(tmp_path)
    for number in (1, 2):
        swept(file, tmp_path / str(number), shard=Shard(number, 3))
    code, out, _ = call(monkeypatch, capsys, "report", tmp_path / "1", tmp_path / "2", "--out", tmp_path / "page.html")
    assert (code, out.strip()) == (0, str(tmp_path / "page.html"))
    assert "4 of 12 samples are not flown" in (tmp_path / "page.html").read_text()
    other = written(tmp_path, before=FLIGHT.replace("0.05", "0.06"), name="other.yaml")
    swept(other, tmp_path / "3", shard=Shard(3, 3))
    code, _, err = call(monkeypatch, capsys, "report", tmp_path / "1", tmp_path / "3", "--out", tmp_path / "no.html")
    assert code == 2
    assert err == f"{tmp_path}/3: holds another sweep than {tmp_path}/1; what differs: scenario\n"


def test_a_sweep_in_which_nothing_could_be_judged_has_a_page(tmp_path):
    (tmp_path / "draw.py").write_text("def draw(k, rng):\n    return {'guidance.speed_m_s': -1.0}\n")
    file = written(tmp_path, "samples: {count: 3, generator: {python: 'draw.py:draw'}}\n")
    result = swept(file, tmp_path / "out", workers_as="threads")
    root = parsed(sweep_report(load_sweep([result.folder])))
    said = " ".join(root.find("body").itertext())
    assert "got -1.0 (sample 0)" in said
