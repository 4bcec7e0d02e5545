"""Files with something wrong in them: never a traceback, never a hang, and the place is that of the cause."""

from __future__ import annotations

import re
import signal
import warnings
from contextlib import contextmanager

import pytest
from support.mutations import CHANGES, mutated
from support.places import MODELS, SCENARIO_FILES

from cube_sim.commands.pages import scenario_examples
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load

QUICK, ALL = 310, 10_000
LONGEST_S = 60
"""Far beyond what any file takes: who is not done by then hangs."""
_PLACE = re.compile(r"(\d+):(\d+): \S")
_WHOLE = ("is larger than", "cannot be read")


def texts() -> dict[str, str]:
    """The shipped scenarios and the examples of the documentation, by name."""
    found = {path.stem: path.read_text() for path in SCENARIO_FILES}
    for name, block in scenario_examples.BLOCKS.items():
        key = re.split(r"[.:]", name)[0]
        gone = rf"(?:{key}|path)" if key in ("phases", "waypoints") else key
        whole = re.sub(rf"^{gone}:.*\n(?:[ \t-].*\n)*", "", scenario_examples.WHOLE, flags=re.MULTILINE)
        found[f"docs {name}"] = whole + block
    return found


TEXTS = texts()


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "models").symlink_to(MODELS)
    (tmp_path / "scenarios").mkdir()
    for path in SCENARIO_FILES:
        (tmp_path / "scenarios" / path.name).symlink_to(path)
    (tmp_path / "scenarios" / "survey.csv").write_text("x_m,y_m,z_m\n0,0,-5\n8,0,-5\n8,8,-5\n")
    return tmp_path / "scenarios"


@contextmanager
def no_hang(seed):
    def too_long(*_):
        raise TimeoutError(f"seed {seed} has not ended")

    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(LONGEST_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def wrong_with(folder, seed: int, fly: bool = False) -> tuple[str, list[str]]:
    """What a mutated file shows that is not as it should be; the change, and lines."""
    name, change = mutated(TEXTS, seed)
    path = folder / "mutated.yaml"
    path.write_bytes(change.content)
    told = f"seed {seed}: {change.what} in {name}"
    try:
        with warnings.catch_warnings(), no_hang(seed):
            warnings.simplefilter("error")
            loaded = load(path)
            if fly:
                prepare(loaded)
    except ScenarioError as error:
        return change.what, [f"{told}: {each}" for each in misplaced(path, change, error.mistakes)]
    except Exception as error:
        return change.what, [f"{told}: {type(error).__name__}: {error}"]
    return change.what, [f"{told}: taken as right"] if change.refused else []


def misplaced(path, change, mistakes):
    """Mistakes that name no place of the file, and that none names the line of the cause."""
    lines = change.content.decode("utf-8", "replace").splitlines() or [""]
    named = set()
    for mistake in mistakes:
        inside = mistake.removeprefix(f"{path}:")
        place = _PLACE.match(inside)
        if place is None:
            if not inside.strip().startswith(_WHOLE):
                yield f"no place in {mistake!r}"
            continue
        line, column = int(place[1]), int(place[2])
        if not 1 <= line <= len(lines) + 1 or column > max(map(len, lines)) + 2:
            yield f"a place outside the file in {mistake!r}"
        if "\n" in mistake:
            yield f"several lines in {mistake!r}"
        named.add(line)
    if change.lines and not named & set(change.lines):
        yield f"the cause is in line {change.lines}, told is {mistakes[:3]}"


def test_the_examples_themselves_are_right(folder):
    for name, text in TEXTS.items():
        path = folder / "example.yaml"
        path.write_text(text)
        assert load(path).scenario.schema_version == 1, name


def test_mutated_files_are_refused_where_the_cause_stands(folder):
    kinds, wrong = set(), []
    for seed in range(QUICK):
        kind, lines = wrong_with(folder, seed)
        kinds.add(kind)
        wrong += lines
    assert wrong == []
    assert len(kinds) >= len(CHANGES) - 2


@pytest.mark.campaign
@pytest.mark.parametrize("tenth", range(10))
def test_ten_thousand_mutated_files(folder, tenth):
    """One in ten is held against its vehicle as well, as before a flight."""
    seeds = range(QUICK + tenth * ALL // 10, QUICK + (tenth + 1) * ALL // 10)
    wrong = [line for seed in seeds for line in wrong_with(folder, seed, fly=seed % 10 == 0)[1]]
    assert wrong == []
