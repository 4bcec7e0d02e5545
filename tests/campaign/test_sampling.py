"""What sample k flies: a function of the seed, of k and of the key, checked before anything flies."""

from __future__ import annotations

from itertools import product
from math import comb

import numpy as np
import pytest
from scipy import stats
from support.scenario_files import FLIGHT, mistakes, write

from cube_sim.campaign.drawing import drawn
from cube_sim.campaign.sample_flight import drawn_columns
from cube_sim.campaign.sampling import SamplePlan, count, sample, variation
from cube_sim.errors import ScenarioError
from cube_sim.mission.hull import flown_hull
from cube_sim.scenario import load
from cube_sim.scenario.distribution_blocks import (
    ChoiceBlock,
    DirectionBlock,
    IntegersBlock,
    LogNormalBlock,
    NormalBlock,
    UniformBlock,
)

SPEED = "guidance.speed_m_s: {distribution: uniform, low: 0.3, high: 0.5}"


def sampled(folder, vary: str = SPEED, *, count: int | None = 20, more: str = "", before: str = FLIGHT):
    """A loaded scenario whose samples vary some keys."""
    text = before + "samples:\n" + (f"  count: {count}\n" if count else "") + more
    text += "  vary:\n" + "".join(f"    {line}\n" for line in vary.splitlines()) if vary else ""
    return load(write(folder, text))


def refused(folder, vary: str, **options) -> list[str]:
    """What is wrong with it, without the folder."""
    with pytest.raises(ScenarioError) as caught:
        SamplePlan(sampled(folder, vary, **options)).require_possible()
    return [line.replace(f"{folder}/", "") for line in caught.value.mistakes]


def test_a_sample_is_a_scenario_without_samples(tmp_path):
    loaded = sampled(tmp_path)
    flown = sample(loaded, 3).scenario
    assert flown.samples is None
    assert flown.guidance.speed_m_s == variation(loaded, 3)["guidance.speed_m_s"] != loaded.scenario.guidance.speed_m_s
    same = {"samples": None, "guidance": loaded.scenario.guidance, "seed": 0}
    assert flown.model_copy(update=same) == loaded.scenario.model_copy(update=same)


def test_values_depend_on_the_seed_the_number_and_the_key_alone(tmp_path):
    current = "current_m_s.1: {distribution: normal, mean: 0, std: 0.1}"
    mass = "knowledge.mass: {distribution: sobol, low: 0.9, high: 1.1}"
    path = "guidance.speed_m_s"
    alone = [variation(sampled(tmp_path), k)[path] for k in range(5)]
    assert len(set(alone)) == 5
    for vary in (f"{current}\n{SPEED}", f"{SPEED}\n{current}\n{mass}"):
        assert [variation(sampled(tmp_path, vary, count=7), k)[path] for k in (4, 0, 2)] == [
            alone[k] for k in (4, 0, 2)
        ]
    other = [variation(sampled(tmp_path, more="  seed: 1\n"), k)[path] for k in range(5)]
    assert not set(alone) & set(other)


def test_each_sample_has_noise_of_its_own_unless_told(tmp_path):
    loaded = sampled(tmp_path)
    assert len({sample(loaded, k).scenario.seed for k in range(20)}) == 20
    assert sample(sampled(tmp_path, more="  vary_seed: false\n"), 3).scenario.seed == loaded.scenario.seed
    told = sampled(tmp_path, "seed: {distribution: choice, values: [7]}")
    assert sample(told, 3).scenario.seed == 7


def test_no_sample_beyond_the_last(tmp_path):
    loaded = sampled(tmp_path)
    assert count(loaded) == 20
    assert count(load(write(tmp_path, FLIGHT))) == 0
    with pytest.raises(ScenarioError, match=r"mission.yaml:12:3: samples: no sample 20: there are 0 to 19"):
        sample(loaded, 20)
    with pytest.raises(ScenarioError, match="has no samples: block"):
        sample(load(write(tmp_path, FLIGHT)), 0)


def of(kind, **keys):
    return kind(distribution=kind.model_fields["distribution"].annotation.__args__[0], **keys)


TRUNCATED = stats.truncnorm((0.5 - 1.0) / 0.4, (1.2 - 1.0) / 0.4, loc=1.0, scale=0.4)
FAR = stats.truncnorm(4.0, 5.0)
LOG = stats.lognorm(0.3, scale=2.0)


@pytest.mark.parametrize(
    ("distribution", "law"),
    [
        (of(UniformBlock, low=-1.0, high=3.0), stats.uniform(-1.0, 4.0)),
        (of(NormalBlock, mean=2.0, std=0.5), stats.norm(2.0, 0.5)),
        (of(NormalBlock, mean=1.0, std=0.4, at_least=0.5, at_most=1.2), TRUNCATED),
        (of(NormalBlock, mean=0.0, std=1.0, at_least=4.0, at_most=5.0), FAR),
        (of(LogNormalBlock, median=2.0, log_std=0.3), LOG),
        (of(LogNormalBlock, median=2.0, log_std=0.3, at_least=-1.0), LOG),
    ],
)
def test_draws_follow_their_law(distribution, law):
    """Kolmogorov and Smirnov's test at one in a thousand; the streams are fixed, so it never fails by chance."""
    draws = [drawn(distribution, np.random.default_rng(seed)) for seed in range(2000)]
    assert stats.kstest(draws, law.cdf).pvalue > 1e-3


def test_whole_numbers_and_choices_come_as_often_as_they_should():
    whole = [drawn(of(IntegersBlock, low=2, high=5), np.random.default_rng(seed)) for seed in range(2000)]
    assert stats.chisquare(np.bincount(whole)[2:]).pvalue > 1e-3
    assert {type(each) for each in whole} == {int}
    weighted = of(ChoiceBlock, values=["a", "b", "never"], weights=[3.0, 1.0, 0.0])
    words = [drawn(weighted, np.random.default_rng(seed)) for seed in range(2000)]
    assert stats.binomtest(words.count("a"), 2000, 0.75).pvalue > 1e-3
    assert "never" not in words


def test_directions_are_even_and_lengths_in_range():
    level = np.array([drawn(of(DirectionBlock, low=0.1, high=0.2), np.random.default_rng(k)) for k in range(2000)])
    lengths = np.linalg.norm(level, axis=1)
    assert np.all(level[:, 2] == 0.0)
    assert stats.kstest(lengths, stats.uniform(0.1, 0.1).cdf).pvalue > 1e-3
    assert stats.kstest(np.arctan2(level[:, 1], level[:, 0]), stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 1e-3
    space = of(DirectionBlock, high=1.0, plane="any")
    up = np.array([drawn(space, np.random.default_rng(k)) for k in range(2000)])
    heights = up[:, 2] / np.linalg.norm(up, axis=1)
    assert stats.kstest(heights, stats.uniform(-1.0, 2.0).cdf).pvalue > 1e-3


def test_a_list_takes_one_draw_for_each_entry_or_one_for_all(tmp_path):
    loaded = sampled(
        tmp_path,
        "initial.position_m: {distribution: uniform, gives: offset, low: [-1, -1, 0], high: [1, 1, 0]}\n"
        "path.end_m: {distribution: uniform, gives: factor, low: 0.9, high: 1.1}",
    )
    x, y, z = sample(loaded, 0).scenario.initial.position_m
    assert z == -5.0
    assert x != y
    assert max(abs(x), abs(y)) <= 1.0
    end = np.array(sample(loaded, 0).scenario.path.end_m)
    np.testing.assert_allclose(end, variation(loaded, 0)["path.end_m"] * np.array([4.0, 0.0, -5.0]))


def test_an_entry_of_a_list_that_the_file_leaves_out(tmp_path):
    loaded = sampled(tmp_path, "current_m_s.1: {distribution: uniform, low: 0.1, high: 0.2}")
    assert sample(loaded, 0).scenario.current_m_s == (0.0, variation(loaded, 0)["current_m_s.1"], 0.0)


@pytest.mark.parametrize(("gives", "low", "high"), [("percent", -5, 5), ("factor", 0.95, 1.05), ("offset", -6, 6)])
def test_a_parameter_of_the_model_changes_from_what_it_has(tmp_path, gives, low, high):
    vary = f"parameters.hull:mass: {{distribution: uniform, gives: {gives}, low: {low}, high: {high}}}"
    loaded = sampled(tmp_path, vary)
    mass = flown_hull(load(write(tmp_path, FLIGHT))).vehicle.mass_matrix[0, 0]
    number = variation(loaded, 4)["parameters.hull:mass"]
    wanted = {"percent": mass * (1 + number / 100), "factor": mass * number, "offset": mass + number}[gives]
    assert flown_hull(sample(loaded, 4)).vehicle.mass_matrix[0, 0] == pytest.approx(wanted, rel=1e-12)
    assert wanted != mass


def test_a_parameter_that_the_scenario_has_changes_from_there(tmp_path):
    text = FLIGHT + "parameters: {hull:mass: [100.0], T1:thruster_lag: [0.3], T2:thruster_lag: [0.1]}\n"
    vary = "parameters.hull:mass: {distribution: choice, gives: factor, values: [1.1]}\n"
    vary += "parameters.hull:thruster_lag: {distribution: choice, gives: factor, values: [2.0]}"
    hull = flown_hull(sample(sampled(tmp_path, vary, before=text), 0))
    assert hull.vehicle.mass_matrix[0, 0] == pytest.approx(110.0)
    lags = dict(zip(hull.vehicle.thrusters.names, hull.model.actuator_dynprm[:, 0], strict=True))
    assert (lags["T1"], lags["T2"], lags["T3"]) == (0.6, 0.2, 0.04)


def test_one_number_for_a_parameter_of_one(tmp_path):
    loaded = sampled(tmp_path, "parameters.hull:mass: {distribution: uniform, low: 120, high: 130}")
    assert sample(loaded, 0).scenario.parameters["hull:mass"] == (variation(loaded, 0)["parameters.hull:mass"],)


def test_grids_are_gone_through(tmp_path):
    vary = "knowledge.mass: {distribution: grid, values: [0.9, 1.1]}\n"
    vary += "guidance.speed_m_s: {distribution: grid, low: 0.2, high: 0.4, points: 3}\n"
    vary += "current_m_s.0: {distribution: uniform, low: 0, high: 0.1}"
    loaded = sampled(tmp_path, vary, count=None)
    assert count(loaded) == 6
    seen = [variation(loaded, k) for k in range(6)]
    points = [(each["guidance.speed_m_s"], each["knowledge.mass"]) for each in seen]
    assert points == [*product([0.2, pytest.approx(0.3), 0.4], [0.9, 1.1])]
    again = sampled(tmp_path, vary, count=12)
    assert [variation(again, k) for k in range(6)] == seen
    assert variation(again, 7)["knowledge.mass"] == 1.1
    assert variation(again, 7)["current_m_s.0"] != seen[1]["current_m_s.0"]


def test_sobol_points_fill_evenly_in_whatever_order_they_are_asked_for(tmp_path):
    vary = "knowledge.mass: {distribution: sobol, low: 0.5, high: 1.5}\n"
    vary += "initial.position_m: {distribution: sobol, gives: offset, low: [0, 0, 0], high: [1, 1, 1]}"
    samples = SamplePlan(sampled(tmp_path, vary, count=64))

    def point(k):
        values = samples.sample(k).values
        return [values["knowledge.mass"] - 0.5, *values["initial.position_m"]]

    points = np.array([point(k) for k in range(64)])
    for column in points.T:  # one point in each 64th, which no independent draws do
        assert sorted((column * 64).astype(int)) == list(range(64))
    backwards = SamplePlan(sampled(tmp_path, vary, count=1000))
    for k in (63, 5, 5, 6, 40, 0):
        values = backwards.sample(k).values
        assert [values["knowledge.mass"] - 0.5, *values["initial.position_m"]] == points[k].tolist()


def test_every_combination_of_lost_thrusters(tmp_path):
    loaded = sampled(tmp_path, "", count=None, more="  lost_thrusters: {losses: [0, 1, 2], at_s: 0.2}\n")
    assert count(loaded) == 1 + 8 + comb(8, 2)
    lost = [tuple(variation(loaded, k)["lost_thrusters"]) for k in range(37)]
    assert len(set(lost)) == 37
    assert sorted(map(len, lost)) == [0] + [1] * 8 + [2] * 28
    assert sample(loaded, 0).scenario.events == ()
    (event,) = sample(loaded, 36).scenario.events
    assert (event.at_s, event.thrusters, event.state) == (0.2, lost[36], "dead")


def test_drawn_losses_join_the_events_of_the_scenario(tmp_path):
    text = FLIGHT + "events:\n  - {kind: current, at_s: 0.1, current_m_s: [0.1, 0, 0]}\n"
    more = "  lost_thrusters: {losses: 1, thrusters: [T2, T5], choose: random, at_s: 0.1, until_s: 0.4}\n"
    loaded = sampled(tmp_path, "events.0.at_s: {distribution: uniform, low: 0, high: 0.3}", more=more, before=text)
    seen = set()
    for k in range(20):
        current, dead = sample(loaded, k).scenario.events
        assert current.at_s == variation(loaded, k)["events.0.at_s"]
        assert 0.1 <= dead.at_s <= 0.4
        seen |= set(dead.thrusters)
    assert seen == {"T2", "T5"}


GENERATOR = """
def drawn(k, rng, low=0.0):
    return {"guidance.speed_m_s": rng.uniform(low, 0.5), "path.end_m": [4.0 + k, 0, -5], "name": f"mission_{k}"}
"""


def test_a_generator_of_ones_own(tmp_path):
    (tmp_path / "draw.py").write_text(GENERATOR)
    more = "  generator: {python: draw.py:drawn, options: {low: 0.4}}\n"
    loaded = sampled(tmp_path, "", more=more)
    flown = sample(loaded, 3).scenario
    assert (flown.name, flown.path.end_m) == ("mission_3", (7.0, 0.0, -5.0))
    assert 0.4 <= flown.guidance.speed_m_s <= 0.5
    assert flown == sample(loaded, 3).scenario
    assert sample(loaded, 4).scenario.guidance.speed_m_s != flown.guidance.speed_m_s
    both = sampled(tmp_path, SPEED, more=more)
    assert sample(both, 3).scenario.guidance.speed_m_s == variation(sampled(tmp_path), 3)["guidance.speed_m_s"]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("return 3", "draw.py:drawn gives 3; a mapping of dotted paths to values is right"),
        ("return {'samples.count': 3}", "draw.py:drawn gives samples; it gives what one of them flies"),
        ("return 1 / k", "draw.py:2: ZeroDivisionError: division by zero"),
    ],
)
def test_a_generator_that_gives_nothing(tmp_path, body, said):
    (tmp_path / "draw.py").write_text(f"def drawn(k, rng):\n    {body}\n")
    loaded = sampled(tmp_path, "", more="  generator: {python: 'draw.py:drawn'}\n")
    with pytest.raises(ScenarioError) as caught:
        sample(loaded, 0)
    assert said in str(caught.value)
    assert "mission.yaml:13:" in str(caught.value)


def test_a_generator_with_notes_says_itself_what_the_row_has(tmp_path):
    body = "    return {'guidance.speed_m_s': 0.3 + 0.1 * k}, {'kind': 'calm', 'parts': ['a', 'b'], 'sizes': [1, 2]}\n"
    (tmp_path / "draw.py").write_text(f"def drawn(k, rng):\n{body}")
    vary = "current_m_s.0: {distribution: uniform, low: 0, high: 0.1}"
    loaded = sampled(tmp_path, vary, more="  generator: {python: 'draw.py:drawn'}\n")
    plan = SamplePlan(loaded)
    drawn = plan.sample(2)
    assert plan.scenario_of(drawn).scenario.guidance.speed_m_s == pytest.approx(0.5)
    assert set(drawn.values) == {"current_m_s.0"}
    assert drawn_columns(drawn) == {
        "note.kind": "calm",
        "note.parts": "a+b",
        "note.sizes.0": 1,
        "note.sizes.1": 2,
        "current_m_s.0": drawn.values["current_m_s.0"],
    }


def test_settings_of_the_samples_go_with_them(tmp_path):
    (tmp_path / "draw.py").write_text("def drawn(k, rng, speed=0.1):\n    return {'guidance.speed_m_s': speed}\n")
    more = "  generator: {python: 'draw.py:drawn'}\n"
    file = sampled(tmp_path, "seed: {distribution: choice, values: [3]}", more=more).path
    loaded = load(file, {"samples.generator.options.speed": 0.45, "samples.vary.seed.values": [7]})
    flown = sample(loaded, 1).scenario
    assert (flown.guidance.speed_m_s, flown.seed, flown.samples) == (0.45, 7, None)


def test_a_value_that_is_set_and_drawn_is_refused(tmp_path):
    """It would be that of no sample; where a change of it is drawn, it is that of all."""
    file = sampled(tmp_path, "current_m_s: {distribution: direction, high: 0.1}").path
    with pytest.raises(ScenarioError) as caught:
        SamplePlan(load(file, {"current_m_s": [0.3, 0, 0]}))
    said = "override current_m_s: samples.vary draws current_m_s: the value would be that of no sample"
    assert str(caught.value) == said
    file = sampled(tmp_path, "guidance.speed_m_s: {distribution: uniform, gives: factor, low: 1, high: 1.1}").path
    assert sample(load(file, {"guidance.speed_m_s": 0.2}), 0).scenario.guidance.speed_m_s == pytest.approx(
        0.21, rel=0.06
    )


def test_grids_of_more_points_than_anybody_flies_are_refused(tmp_path):
    axis = "{distribution: grid, low: 0.1, high: 0.2, points: 4000}"
    vary = "\n".join(f"{key}: {axis}" for key in ("guidance.speed_m_s", "current_m_s.0"))
    with pytest.raises(ScenarioError, match="the grids have 16000000 points together, more than 10000000 samples"):
        sampled(tmp_path, vary, count=None)


def test_a_generator_whose_scenario_cannot_be_flown(tmp_path):
    (tmp_path / "draw.py").write_text("def drawn(k, rng):\n    return {'guidance.speed_m_s': -1.0}\n")
    loaded = sampled(tmp_path, "", more="  generator: {python: 'draw.py:drawn'}\n")
    with pytest.raises(
        ScenarioError, match=r"override guidance.speed_m_s: must be at least 0.0001, got -1.0 \(sample 2\)"
    ):
        sample(loaded, 2)


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        ("guidance.sped_m_s: {distribution: uniform, low: 0.3, high: 0.5}",
         "mission.yaml:14:24: samples.vary.guidance.sped_m_s: guidance.sped_m_s: unknown key; did you mean speed_m_s?"),
        ("guidance.speed_m_s: {distribution: uniform, low: -0.1, high: 0.5}",
         "mission.yaml:14:25: samples.vary.guidance.speed_m_s: may be -0.1: must be at least 0.0001, got -0.1"),
        ("guidance.speed_m_s: {distribution: normal, mean: 0.3, std: 0.1}",
         "mission.yaml:14:25: samples.vary.guidance.speed_m_s: may be -0.3"),
        ("control_period_s: {distribution: uniform, low: 0.01, high: 0.02}",
         "mission.yaml:14:23: samples.vary.control_period_s: may be 0.0138196601125: must be an integer multiple of"
         " physics.step_s: 0.0138197 s is 1.38197 steps of 0.01 s"),
        ("guidance.law: {distribution: choice, values: [path_following, pth]}",
         "mission.yaml:14:19: samples.vary.guidance.law: may be 'pth': got the text 'pth'; known: path_following,"
         " trajectory_tracking"),
        ("current_m_s: {distribution: uniform, low: [0, 0], high: [0.1, 0.1]}",
         "mission.yaml:14:18: samples.vary.current_m_s: may be [0.0, 0.0]: current_m_s.2: a number is missing here: the"
         " list is too short"),
        ("current_m_s: {distribution: direction, high: 0.1}\ncurrent_m_s.0: {distribution: uniform, low: 0, high: 0.1}",
         "mission.yaml:15:20: samples.vary.current_m_s.0: lies in current_m_s, which is varied too: one of the two"
         " would be lost"),
        ("current_m_s.3: {distribution: uniform, low: 0, high: 0.1}",
         "mission.yaml:14:20: samples.vary.current_m_s.3: current_m_s is a list of 3, '3' is not an index of it"),
        ("guidance.law: {distribution: uniform, gives: factor, low: 0.9, high: 1.1}",
         "mission.yaml:14:19: samples.vary.guidance.law: there is no number that a factor could be of, but"
         " 'path_following'"),
        ("initial.position_m: {distribution: uniform, gives: offset, low: [0, 0], high: [1, 1]}",
         "mission.yaml:14:25: samples.vary.initial.position_m: takes 1 number, or one for each of the 3 that stand"
         " there; not 2"),
        ("guidance.speed_m_s: {distribution: unifrom, low: 0.1, high: 0.5}",
         "mission.yaml:14:40: samples.vary.guidance.speed_m_s.distribution: unknown distribution 'unifrom';"
         " did you mean uniform?"),
        ("guidance.speed_m_s: {distribution: uniform, low: 0.5, high: 0.1}",
         "mission.yaml:14:65: samples.vary.guidance.speed_m_s.high: must not be below low: 0.1 against 0.5"),
        ("guidance.speed_m_s: {distribution: normal, mean: 0.5, std: 0.1, at_least: 2}",
         "mission.yaml:14:79: samples.vary.guidance.speed_m_s.at_least: lies more than 6 standard deviations out:"
         " nothing is left to draw"),
        ("guidance.speed_m_s: {distribution: normal, mean: .nan, std: 0.1}",
         "mission.yaml:14:54: samples.vary.guidance.speed_m_s.mean: must be a number of at most 1e+12 either way, got"
         " nan"),
        ("initial.position_m: {distribution: uniform, low: [0, 0, -5], high: [0, 0, .inf]}",
         "mission.yaml:14:79: samples.vary.initial.position_m.high.2: must be finite, got inf"),
        ("samples.count: {distribution: uniform, low: 1, high: 2}",
         "mission.yaml:14:20: samples.vary.samples.count: is what the samples are made of, and not varied"),
        ("parameters.hull:mas: {distribution: uniform, gives: percent, low: -5, high: 5}",
         "mission.yaml:14:26: samples.vary.parameters.hull:mas: no 'hull:mas'; the model has"),
        ("parameters.hull:mass: {distribution: uniform, gives: percent, low: -105, high: 5}",
         "mission.yaml:14:27: samples.vary.parameters.hull:mass: may be -105.0:"),
    ],
)  # fmt: skip
def test_what_cannot_be_flown_is_refused_before(tmp_path, vary, said):
    (line,) = refused(tmp_path, vary)
    assert line.startswith(said)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("  lost_thrusters: {losses: 1, thrusters: [T1, T9]}\n",
         "mission.yaml:12:47: samples.lost_thrusters.thrusters.1: no thruster 'T9'; the model has T1, T2,"),
        ("  lost_thrusters: {losses: 9}\n",
         "mission.yaml:12:28: samples.lost_thrusters.losses: must be at most 8, the number of thrusters"),
        ("  lost_thrusters: {losses: [1, 1]}\n",
         "mission.yaml:12:28: samples.lost_thrusters.losses: must be different whole numbers, each at least 0"),
        ("  lost_thrusters: {losses: 1, at_s: 3}\n",
         "mission.yaml:12:37: samples.lost_thrusters.at_s: is after the end at 0.5 s"),
        ("  required: {pass_rate: 0.9}\n",
         "mission.yaml:11:1: samples.count: say how many samples there are: no grid and no combination does"),
        ("  generator: {python: 'nothing.py:draw'}\n", "mission.yaml:12:23: samples.generator.python: no such file:"),
        ("  count: 3\n  generator: {python: 'draw.py:drwn'}\n",
         "mission.yaml:13:23: samples.generator.python: draw.py has no drwn; did you mean drawn?"),
    ],
)  # fmt: skip
def test_a_block_that_makes_no_samples_is_refused(tmp_path, more, said):
    (tmp_path / "draw.py").write_text(GENERATOR)
    (line,) = refused(tmp_path, "", count=None, more=more)
    assert line.startswith(said)


def test_mistakes_of_samples_given_from_outside(tmp_path):
    wrong = {"samples": {"count": 3, "vary": {"guidance.speed_m_s": {"distribution": "uniform", "low": 0, "high": 1}}}}
    (line,) = mistakes(write(tmp_path, FLIGHT), wrong)
    assert line.startswith("override samples: samples.vary.guidance.speed_m_s: may be 0.0: must be at least 0.0001")


def test_a_scenario_with_samples_flies_as_it_stands(tmp_path):
    """Its record is that of the scenario without the block: one flight is one flight."""
    from cube_sim.simulation import fly

    with_samples = fly(sampled(tmp_path), out=tmp_path / "with", record="none")
    without = fly(load(write(tmp_path, FLIGHT)), out=tmp_path / "without", record="none")
    assert with_samples.checks == without.checks
    resolved = [(tmp_path / name / "resolved.yaml").read_text() for name in ("with", "without")]
    assert resolved[0] == resolved[1]
    assert "samples" not in resolved[0]
