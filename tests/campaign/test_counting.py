"""What counts for the rate that is required: some samples, groups of them, what comes out as it was foretold."""

from __future__ import annotations

import pyarrow as pa
import pytest
from pydantic import ValidationError

from cube_sim.campaign.counting import NoteCount, counted, counted_by_note
from cube_sim.campaign.pass_rate import judged
from cube_sim.campaign.summary import limits_of, relative_margins, worst_samples
from cube_sim.scenario.samples_block import RequiredBlock, SamplesBlock

VERDICTS = ["PASS", "FAIL", "PASS", "PASS", "ERROR", "FAIL", "PASS"]
VEHICLES = ["a", "a", "b", "b", "c", "d", "e"]
FORECAST = [True, True, True, True, True, False, False]
KIND = ["calm", "calm", "calm", "rough", "rough", "rough", "rough"]
ROWS = pa.table(
    {
        "sample": range(7),
        "verdict": VERDICTS,
        "reason": [f"because {k}" for k in range(7)],
        "note.vehicle": VEHICLES,
        "note.forecast": FORECAST,
        "note.kind": KIND,
        "note.same": ["all"] * 7,
        "note.sentence": [f"of {len(kind)} letters, {'and so on ' * 6}" for kind in KIND],
        "note.seed": [40 + k for k in range(7)],
        "note.words": [f"every one another, {k}" for k in range(7)],
        "check.error.margin": [0.1, -0.2, 0.3, 0.4, None, -0.6, 0.7],
        "check.error.verdict": VERDICTS,
    }
)


def found(**required):
    came = counted(ROWS, RequiredBlock(**required) if required else None)
    return (came.passed, came.failed, came.errors), sorted(came.against), came.words


def test_every_sample_should_pass_unless_something_else_is_said():
    assert found() == ((4, 2, 1), [1, 4, 5], "samples pass")
    assert found(pass_rate=0.5) == found()


def test_only_some_count():
    assert found(where={"forecast": True}) == ((3, 1, 1), [1, 4], "samples, forecast true, pass")
    assert found(where={"kind": "rough", "seed": 43}) == ((1, 0, 0), [], "samples, kind rough, seed 43, pass")
    assert found(where={"colour": "red"})[0] == (0, 0, 0)
    assert judged(0, 0, 0, RequiredBlock(where={"a": 1}), "samples, a 1, pass").verdict == "ERROR"


def test_an_error_that_nothing_is_known_of_counts_wherever_some_do():
    """Its generator has failed: nobody can say that it would not have counted."""
    rows = pa.table({"sample": range(3), "verdict": ["PASS", "ERROR", "FAIL"], "note.forecast": [True, None, False]})
    came = counted(rows, RequiredBlock(where={"forecast": True}))
    assert ((came.passed, came.failed, came.errors), came.against) == ((1, 0, 1), {1})
    undrawn = pa.table({"sample": range(2), "verdict": ["ERROR"] * 2})
    assert counted(undrawn, RequiredBlock(where={"forecast": True})).errors == 2


def test_what_comes_out_as_foretold_has_passed():
    """One that should not pass, and could not be judged, has not passed."""
    assert found(forecast="forecast") == ((4, 2, 1), [1, 4, 6], "samples come out as forecast says")
    error = ROWS.set_column(1, "verdict", pa.array([*VERDICTS[:5], "ERROR", "PASS"]))
    assert counted(error, RequiredBlock(forecast="forecast")).against == {1, 4, 6}


def test_a_forecast_that_nobody_made_is_none():
    came, against, _ = found(forecast="kind")
    assert (came, against) == ((0, 6, 1), list(range(7)))


def test_samples_of_one_group_pass_together():
    assert found(each="vehicle") == ((2, 2, 1), [1, 4, 5], "groups by vehicle pass")
    together = found(each="vehicle", forecast="forecast")
    assert together == ((2, 2, 1), [1, 4, 6], "groups by vehicle come out as forecast says")
    # one flight that should not pass is enough for a vehicle that should not, and one that does not
    one = ROWS.set_column(4, "note.forecast", pa.array([True, False, *FORECAST[2:]]))
    assert counted(one, RequiredBlock(each="vehicle", forecast="forecast")).against == {4, 6}


def test_the_verdict_says_what_it_counts():
    came = counted(ROWS, RequiredBlock(each="vehicle", forecast="forecast"))
    told = judged(came.passed, came.failed, came.errors, RequiredBlock(), came.words)
    assert told == ("FAIL", "2 of 5 groups by vehicle come out as forecast says, all of them wanted")
    rate = judged(2, 2, 1, RequiredBlock(pass_rate=0.9), came.words)
    assert (rate.verdict, rate.detail[:58]) == ("FAIL", "2 of 5 groups by vehicle come out as forecast says: a pass")


def test_the_worst_are_those_that_speak_against_it():
    worst = worst_samples(ROWS, {"error": 1.0}, 5, {1, 4, 6})
    assert [each.sample for each in worst] == [4, 1, 6, 5, 0]
    assert [each.against for each in worst] == [True, True, True, False, False]
    assert worst[2].reason == "passes, and should not; smallest margin 70 % of the limit"
    assert worst[3].reason == "because 5"


def test_notes_in_words_are_counted_by_their_values():
    tables = counted_by_note(ROWS, "forecast", 12)
    assert list(tables) == ["vehicle", "kind"]
    assert tables["kind"] == [NoteCount("calm", 3, 2, 1, 0, 3, 2), NoteCount("rough", 4, 2, 1, 1, 2, 1)]
    assert counted_by_note(ROWS, None, 2)["kind"][0] == NoteCount("calm", 3, 2, 1, 0, None, None)
    assert list(counted_by_note(ROWS, None, 2)) == ["forecast", "kind"]


@pytest.mark.parametrize("required", [{"where": {"a": True}}, {"forecast": "a"}, {"each": "a"}])
def test_notes_need_somebody_who_gives_them(required):
    with pytest.raises(ValidationError, match="is about notes, which a generator gives: there is none"):
        SamplesBlock(count=3, required=RequiredBlock(**required))
    with pytest.raises(ValidationError, match="must be a word, a number, true or false"):
        RequiredBlock(where={"a": [1]})


def test_a_limit_that_is_drawn_is_that_of_each_sample():
    limits = [0.1, 0.4, 0.1, None, 0.2, 0.2, 0.2]
    rows = ROWS.append_column("check.error.limit", pa.array(limits))
    assert limits_of(rows, "error", {"error": 9.0}).tolist() == [0.1, 0.4, 0.1, 9.0, 0.2, 0.2, 0.2]
    assert relative_margins(rows, {})[:3].tolist() == pytest.approx([1.0, -0.5, 3.0])
    assert relative_margins(ROWS, {"error": 0.5})[:2].tolist() == pytest.approx([0.2, -0.4])
