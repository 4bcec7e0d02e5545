"""Every recipe of docs/extending.md, followed word by word in a copy of the repository."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import REPO
from support.recipes import recipes

DOCUMENT = REPO / "docs" / "extending.md"
RECIPES = recipes(DOCUMENT)
LEFT_BEHIND = {"logs", "build", "dist"}
TOOLS = Path(sys.executable).parent
LAWS = "pytest -m 'not flight' tests/laws -k 'one_class or every_model'"
"""Those that an addition could break."""
ALWAYS = ("A vehicle", "A check", "An event")
"""The rest makes machine code anew for up to a minute each: a campaign."""


@pytest.fixture
def copy(tmp_path):
    """The repository without its history; machine code comes along, its sources are as old as before."""
    for source in REPO.iterdir():
        if source.name == ".ci" or not (source.name.startswith(".") or source.name in LEFT_BEHIND):
            (shutil.copytree if source.is_dir() else shutil.copy2)(source, tmp_path / source.name)
    return tmp_path


def run(command: str, directory: Path) -> None:
    """A command line as a reader types it, but for the number of processes."""
    environment = {
        **os.environ,
        "PATH": f"{TOOLS}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(directory),
        "PYTEST_ADDOPTS": f"-n 0 -p no:cacheprovider --basetemp={directory / '.pytest'}",
    }
    done = subprocess.run(
        ["bash", "-c", command], cwd=directory, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"


def by_title(recipe):
    return recipe.title.replace(" ", "_")


@pytest.mark.flight
@pytest.mark.parametrize("recipe", RECIPES, ids=by_title)
def test_each_fits_the_repository(recipe, copy):
    for step in recipe.steps:
        step.apply(copy)
    run("ruff check . && ruff format --check .", copy)


@pytest.mark.flight
@pytest.mark.parametrize(
    "recipe",
    [
        pytest.param(each, marks=[] if each.title in ALWAYS else pytest.mark.campaign, id=by_title(each))
        for each in RECIPES
    ],
)
def test_each_does_what_it_says(recipe, copy):
    for step in recipe.steps:
        step.apply(copy)
    for command in [*recipe.commands, LAWS]:
        run(command, copy)


def test_the_table_counts_the_files():
    rows = re.findall(r"^\| \[([^\]]+)\]\(#\S+\) \| (\d+) \| (\d+) \|$", DOCUMENT.read_text(encoding="utf-8"), re.M)
    generated = [{c.split("> ")[1] for c in recipe.commands if "> " in c} for recipe in RECIPES]
    assert rows == [
        (recipe.title.lower(), str(len(recipe.steps) + len(made)), str(len(made)))
        for recipe, made in zip(RECIPES, generated, strict=True)
    ]
