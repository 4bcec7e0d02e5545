"""The page on continuous integration: what a user copies from it can be parsed, and its commands run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import REPO
from support.scenario_files import FLIGHT

from cube_sim.scenario.document import parse
from cube_sim.scenario.finding import is_scenario

PAGE = (REPO / "docs" / "ci.md").read_text()
EXAMPLES = [parse(block) for block in re.findall(r"^```yaml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)]
NAMES = ["github", "gitlab"]
OURS = ("cube-sim", "pytest")
SET = {"${{ matrix.shard }}": "2", "$CI_NODE_INDEX": "2", "$CI_NODE_TOTAL": "4"}


def jobs(example) -> list[tuple[str, list[str]]]:
    """Each job of an example, and what it runs."""
    data = example.data
    if "jobs" in data:
        return [(name, [step["run"] for step in job["steps"] if "run" in step]) for name, job in data["jobs"].items()]
    return [(name, job["script"]) for name, job in data.items() if "script" in job]


def commands() -> list[str]:
    """Every command of cube_sim and of pytest in both examples and on the page, once."""
    scripts = re.findall(r"^```sh\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    lines = [line.partition("  #")[0].strip() for script in scripts for line in script.splitlines()]
    lines += [line for example in EXAMPLES for _, job in jobs(example) for line in job]
    for old, new in SET.items():
        lines = [line.replace(old, new) for line in lines]
    return sorted({line for line in lines if line.startswith(OURS)})


def test_there_are_two_examples_that_parse():
    assert len(EXAMPLES) == len(NAMES)
    for example in EXAMPLES:
        assert example.mistakes == ()
        assert [name for name, _ in jobs(example)][-2:] == ["sweep", "judge"]
        assert all(job for _, job in jobs(example))


def test_every_step_of_the_github_example_does_something():
    for job in EXAMPLES[0].data["jobs"].values():
        assert {"runs-on", "timeout-minutes", "env", "steps"} <= set(job)
        assert all(("uses" in step) != ("run" in step) for step in job["steps"])
        cached = [step["with"]["path"] for step in job["steps"] if step.get("uses", "").startswith("actions/cache@")]
        assert job["env"]["CUBE_SIM_CACHE_DIR"].endswith(f"/{cached[0]}")


@pytest.mark.flight
def test_a_sweep_that_misses_its_rate_fails_in_the_job_that_judges_all_parts(repository):
    folder, run = repository
    sampled = folder / "missions" / "sampled.yaml"
    sampled.write_text(
        sampled.read_text().replace("seed: 1,", "seed: 1, required: {pass_rate: 0.9},").replace("0.05}", "1.0e-9}")
    )
    told = {(wanted(example, "sweep"), wanted(example, "judge")) for example in EXAMPLES}  # both may tell the same
    for parts, judging in told:
        for number in "12":
            for line in parts:
                assert run(line.replace("SHARD", f"{number}/2")).returncode == 0
        assert [run(line).returncode for line in judging] == [1]
        shutil.rmtree(folder / "rows")


def wanted(example, job) -> tuple[str, ...]:
    """What a job runs of cube_sim, whatever its example calls the number of a part."""
    lines = [line for line in dict(jobs(example))[job] if line.startswith("cube-sim")]
    assert lines
    for called in ("${{ matrix.shard }}/4", "$CI_NODE_INDEX/$CI_NODE_TOTAL"):
        lines = [line.replace(called, "SHARD") for line in lines]
    assert job != "sweep" or all("--shard SHARD" in line for line in lines)
    return tuple(lines)


def test_what_is_compiled_is_cached_on_gitlab():
    data = EXAMPLES[1].data
    assert data["variables"]["CUBE_SIM_CACHE_DIR"].removeprefix("$CI_PROJECT_DIR/") in data["default"]["cache"]["paths"]


def test_the_examples_are_no_scenarios(tmp_path):
    for index, block in enumerate(re.findall(r"^```yaml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)):
        file = tmp_path / f"{index}.yaml"
        file.write_text(block)
        assert not is_scenario(file)


@pytest.fixture
def repository(tmp_path):
    """One of a user's, with two scenarios; each command is run in it as its shell would."""
    missions = tmp_path / "missions"
    missions.mkdir()
    (missions / "hover.yaml").write_text(FLIGHT)
    samples = "samples: {count: 8, seed: 1, vary: {current_m_s.0: {distribution: uniform, low: -0.01, high: 0.01}}}"
    sampled = FLIGHT.replace("checks:", f"{samples}\nchecks:").replace("short_flight", "sampled")
    (missions / "sampled.yaml").write_text(sampled)
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["cube_sim.testing"]\n')
    (tmp_path / "pytest.ini").write_text("[pytest]\n")

    def run(command: str) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        environment = {**os.environ, "PATH": path}
        environment.pop("PYTEST_ADDOPTS", None)
        arguments = ["sh", "-c", command]
        return subprocess.run(
            arguments, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600, check=False
        )

    return tmp_path, run


@pytest.mark.flight
@pytest.mark.parametrize("command", commands())
def test_every_command_ends_well_in_a_repository_of_a_user(repository, command):
    folder, run = repository
    done = run(command)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    if "--junitxml" in command:
        assert 'name="sampled[s7]"' in (folder / "report.xml").read_text()


def test_the_page_names_the_options_that_there_are(repository):
    _, run = repository
    told = run("pytest --help").stdout
    options = set(re.findall(r"--scenario-[a-z]+", told))
    assert options == set(re.findall(r"--scenario-[a-z]+", PAGE))
    assert len(options) == 5


def test_the_dockerfile_holds_the_two_commands_of_the_readme():
    readme, dockerfile = (REPO / "README.md").read_text(), (REPO / "Dockerfile").read_text()
    (made,) = set(re.findall(r"^(python3 -m venv .*?) && \.venv/bin/(?:cube-sim run|pytest)", readme, re.MULTILINE))
    assert f"\nRUN {made}\n" in dockerfile
    assert "cube-sim run scenarios/cube_helix.yaml" in dockerfile
    assert re.search(r"^FROM python:3\.11-", dockerfile, re.MULTILINE)
