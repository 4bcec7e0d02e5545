"""Which YAML files are scenarios: told by what they hold, wherever they stand."""

from __future__ import annotations

import json

import pytest
from support.places import FLEET_FILES, SCENARIO_FILES, SCENARIOS
from support.scenario_files import FLIGHT, MINIMAL

from cube_sim.errors import ScenarioError
from cube_sim.scenario.document import parse
from cube_sim.scenario.finding import find, is_scenario

FOREIGN = {
    "workflow.yaml": "name: ci\non: [push]\njobs:\n  test:\n    runs-on: x\n    steps:\n      - run: pytest\n",
    "docker-compose.yml": "services:\n  web:\n    image: nginx\n    ports: ['80:80']\n",
    ".gitlab-ci.yml": "include: other.yml\ntest:\n  script: pytest\n",
    "recipe.yaml": "schema_version: 1\ncontext:\n  name: x\npackage: {name: x, version: 1}\nsource: {path: ..}\n",
    "mkdocs.yml": "site_name: x\nnav:\n  - Home: index.md\nmarkdown_extensions:\n  - x: {y: !!python/name:z.w }\n",
    "broken.yaml": "a: [1, 2\nb: 'x\n",
    "chart.yaml": "{{- if .Values.x }}\napiVersion: v1\n{{- end }}\n",
    "empty.yaml": "",
    "values.yaml": "duration_s: 3\nguidance: {speed_m_s: 1}\n",
    "list.yaml": "- schema_version: 1\n",
    "bytes.yaml": "\x00\x01\x02",
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_foreign_file_is_none(tmp_path, name):
    file = tmp_path / name
    file.write_text(FOREIGN[name])
    assert not is_scenario(file)


@pytest.mark.parametrize("file", SCENARIO_FILES, ids=lambda file: file.stem)
def test_every_shipped_scenario_is_one(file):
    assert is_scenario(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text,
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.encode("utf-16"),  # to be told that it is not UTF-8
        lambda text: text.replace("duration_s", "durtion_s"),  # with mistakes
        lambda text: text.replace("guidance: {", 'guidance: "{'),
        lambda text: text.replace("schema_version: 1", "schema_version: 7"),
        lambda text: text.replace("schema_version: 1", "schema_versoin: 1"),
        lambda text: "# a remark\n---\n" + text,
        lambda text: json.dumps(parse(text).data),
        lambda text: json.dumps(parse(text).data, indent=2),
    ],
)
def test_a_scenario_is_one_however_it_is_written(tmp_path, change):
    file = tmp_path / "x.yaml"
    text = change(MINIMAL)
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert is_scenario(file)


def test_what_includes_a_scenario_is_one(tmp_path):
    (tmp_path / "base.yaml").write_text(FLIGHT)
    above = tmp_path / "above.yaml"
    for text, expected in (
        ("include: base.yaml\nseed: 3\n", True),
        ("seed: 3\ninclude: 'base.yaml'   # of all\n", True),
        ("include: above.yaml\n", False),  # itself
        ("seed: 3\ninclude: above.yaml\n", True),  # its mistake is to be told
        ("include: none.yaml\n", False),
        ("schema_version: 1\nname: x\ninclude: none.yaml\n", True),
        ("schema_version: 1\ninclude:\n  none.yaml\n", True),
        ("checks: []\n'include': 'none at all.yaml'\n", True),
        ("include: none.yaml\nbuild:\n  environment: {name: x}\n  path: x\n", False),
        ("name: x\ninclude:\n  - base.yaml\n", False),
        ("include: [base.yaml]\n", False),
        ("include: .\n", False),
    ):
        above.write_text(text)
        assert is_scenario(above) is expected, text


def test_folders_are_searched_to_any_depth_but_those_of_others(tmp_path):
    for name in ("a.yaml", "deep/er/b.yml", "c.yaml.bak", "run/resolved.yaml", "plain/resolved.yaml", ".git/d.yaml",
                 "venv/e.yaml", "site-packages/f.yaml"):  # fmt: skip
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(FLIGHT)
    (tmp_path / "run" / "verdict.json").write_text("{}")
    (tmp_path / "foreign.yaml").write_text(FOREIGN["workflow.yaml"])
    found = find([tmp_path / "deep", tmp_path, tmp_path / "a.yaml"])
    assert [str(file.relative_to(tmp_path)) for file in found.scenarios] == [
        "deep/er/b.yml",
        "a.yaml",
        "plain/resolved.yaml",
    ]
    assert [file.name for file in found.others] == ["foreign.yaml"]


def test_a_file_that_is_named_is_taken_for_one(tmp_path):
    named = tmp_path / "workflow.yaml"
    named.write_text(FOREIGN["workflow.yaml"])
    assert find([named, named]).scenarios == (named,)


def test_a_folder_without_one_says_so(tmp_path):
    with pytest.raises(ScenarioError, match=r"holds no scenario: there is no YAML file in it$"):
        find([tmp_path])
    (tmp_path / "workflow.yaml").write_text(FOREIGN["workflow.yaml"])
    with pytest.raises(ScenarioError, match=r"holds no scenario: of 1 YAML files in it none is one$"):
        find([tmp_path])


def test_the_repository_holds_its_scenarios_and_no_others():
    assert set(find([SCENARIOS]).scenarios) == {*SCENARIO_FILES, *FLEET_FILES}
