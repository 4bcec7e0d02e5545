"""Whatever is wrong with a vehicle's MJCF is told by file:line:column, in included files too."""

import re
from pathlib import Path

import pytest
from support.edited_cube import T1
from support.places import CUBE, MODEL_FILES

import cube_sim
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.scenario import load_mapping
from cube_sim.vehicle.mjcf.places import elements_of, place_of
from cube_sim.vehicle.vehicle import hull_names

TEXT = CUBE.read_text()


def refused(folder, text, **others):
    """The error of a file, and what stands where it points."""
    for name, content in {"a.xml": text, **{f"{name}.xml": content for name, content in others.items()}}.items():
        (folder / name).write_text(content)
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(folder / "a.xml")
    found = re.match(r"(.*?\.xml):(\d+):(\d+): ", str(caught.value))
    assert found, str(caught.value)
    assert "\n" not in str(caught.value)
    line = Path(found[1]).read_text().splitlines()[int(found[2]) - 1]
    return str(caught.value), Path(found[1]).name, line[int(found[3]) - 1 :]


def numeric(name, *values):
    return f'<numeric name="{name}" data="{" ".join(map(str, values))}"/>'


WRONG = [
    ("hull:added_mass", [1, 2, 3], "has 3 values"),
    ("hull:added_mass", [-1] * 6, "positive semidefinite"),
    ("hull:linear_damping", [-1] * 6, "negative"),
    ("hull:quadratic_damping", [-1] * 6, "negative"),
    ("hull:volume", [-1], "not negative"),
    ("hull:volum", [1], "did you mean volume"),
    ("hul:volume", [1], "no body 'hul'"),
    ("hull_volume", [1], "has no colon"),
    ("water:densty", [1], "nothing that water has"),
    ("hull:centre_of_buoyancy", [0, 0], "it takes 3"),
    ("hull:surface_half_axes", [1, 1, 0], "half-axes [m] are positive"),
    ("hull:thruster_dead_zone", [1, 2], "out of order"),
    ("T1:thruster_pwm", [1, 2], "it takes 3"),
    ("T9:thruster_pwm", [1, 2, 3], "no body or thruster 'T9'"),
    ("T1:thruster_voltage", [0], "positive"),
    ("T1:thruster_power", [-1, 1], "both directions"),
    ("T1:thruster_characteristic", [-1, 5, 0, 0, 1, 1], "decrease"),
    ("hull:thruster_voltage_table", [1, 2, 3], ""),
    ("T1:propeller_diameter", [-0.1], ""),
    ("nowhere:fin_area", [0.1], "no site"),
    ("hull:velocity_products", [1, 2], "rows of"),
    ("hull:cross_flow_stations", [1], ""),
    ("hull:coriolis_of_added_mass", [2], ""),
    ("water:current", [1, 2], "rows of five"),
    ("hull:mass", [1.0], ""),
    ("cube_sim:packed", [1.0], "remove it"),
]


@pytest.mark.parametrize(("name", "values", "said"), WRONG)
@pytest.mark.parametrize("included", [False, True])
def test_a_wrong_number_is_where_it_stands(name, values, said, included, tmp_path):
    kept = re.sub(rf'<numeric name="{re.escape(name)}"[^>]*?/>', "", TEXT, flags=re.DOTALL)
    wrong = numeric(name, *values)
    if included:
        text = kept.replace("</custom>", '</custom>\n<include file="b.xml"/>', 1)
        words, file, there = refused(tmp_path, text, b=f"<mujoco>\n  <custom>\n    {wrong}\n  </custom>\n</mujoco>")
    else:
        words, file, there = refused(tmp_path, kept.replace("</custom>", f"  {wrong}\n</custom>", 1))
    assert file == ("b.xml" if included else "a.xml")
    assert there.startswith((f'<numeric name="{name}"', '<numeric name="hull:cross_flow', '<numeric name="T1:thruster'))
    assert said in words


@pytest.mark.parametrize(
    ("old", "new", "there", "said"),
    [
        (T1, T1 + ' gear="1 0 0 0 0 0"', '<general name="T1"', "has gear"),
        (T1, T1.replace('name="T1"', 'name=""'), "<general", "no name"),
        (T1, T1 + ' dyntype="none"', '<general name="T1"', "dyntype"),
        (T1, T1.replace('site="T1"', 'site="nowhere"'), '<general name="T1"', "nowhere"),
        (T1, T1 + ' gainprm="2"', '<general name="T1"', "gain"),
        (T1, T1 + ' ctrlrange="-0.5 0.5"', '<general name="T1"', "cuts off its curve"),
        (T1, T1 + ' forcerange="-1 1" forcelimited="true"', '<general name="T1"', "cuts off its curve"),
        ("<freejoint", "<!-- --><joint", "<body name=\"hull\"", "no free joint"),
        ("<option ", '<option density="1000" ', "<option", "density"),
    ],
)  # fmt: skip
def test_a_wrong_element_is_where_it_stands(old, new, there, said, tmp_path):
    assert old in TEXT
    words, _, place = refused(tmp_path, TEXT.replace(old, new, 1))
    assert place.startswith(there)
    assert said in words


@pytest.mark.parametrize(
    ("name", "there"),
    [("hull:volume", '<body name="hull"'), ("water:density", "<custom"), ("hull:thruster_characteristic", "<body")],
)
def test_what_is_missing_is_where_it_would_belong(name, there, tmp_path):
    text = re.sub(rf'<numeric name="{name}"[^>]*?/>', "", TEXT, flags=re.DOTALL)
    words, _, place = refused(tmp_path, text)
    assert place.startswith(there)
    assert "is missing" in words


@pytest.mark.parametrize(
    ("added", "there", "said"),
    [
        ("<foo/>", "<foo/>", "unrecognized element"),
        ('<geom typ="box"/>', "<geom typ", "unrecognized attribute: 'typ'"),
        ('<geom type="boxx"/>', "<geom type", "invalid keyword: 'boxx'"),
        ('<geom type="box"/>', '<geom type="box"', "size 0 must be positive"),
        ('<body name="hull"/>', '<body name="hull"/>', "repeated name 'hull'"),
        ("<body><freejoint/></body>", "<body><freejoint", "mass and inertia"),
    ],
)
@pytest.mark.parametrize("included", [False, True])
def test_so_is_what_mujoco_itself_refuses(added, there, said, included, tmp_path):
    if included:
        text = TEXT.replace("<worldbody>", '<include file="b.xml"/>\n<worldbody>', 1)
        words, file, place = refused(tmp_path, text, b=f"<mujoco>\n <worldbody>\n  {added}\n </worldbody>\n</mujoco>")
    else:
        words, file, place = refused(tmp_path, TEXT.replace("</worldbody>", f"  {added}\n</worldbody>", 1))
    assert said in words
    if included and file == "a.xml":  # of what is compiled late MuJoCo does not say which file it came from
        assert place.startswith(("<mujoco", '<body name="hull" '))  # of two of a name the second
    else:
        assert place.startswith(there)


def test_a_file_that_is_no_xml_is_told_where_it_breaks(tmp_path):
    words, file, place = refused(tmp_path, TEXT.replace("</worldbody>", "", 1))
    assert "mismatched tag" in words
    assert file == "a.xml"
    text = TEXT.replace("<worldbody>", '<include file="b.xml"/><worldbody>', 1)
    words, file, place = refused(tmp_path, text, b="<mujoco>\n<worldbody><geom></worldbody>\n</mujoco>")
    assert (file, "mismatched tag" in words) == ("b.xml", True)
    words, file, place = refused(tmp_path, TEXT.replace("<worldbody>", '<include file="c.xml"/><worldbody>', 1))
    assert place.startswith("<include")


def test_a_scenario_says_both_places(tmp_path):
    (tmp_path / "a.xml").write_text(TEXT.replace("</custom>", "<numeric name='hull:volum' data='1'/></custom>", 1))
    path = {"type": "point", "position_m": [0, 0, -5], "heading_deg": 0}
    given = {"schema_version": 1, "name": "x", "model": str(tmp_path / "a.xml"), "seed": 1, "duration_s": 1}
    given |= {"path": path, "guidance": {"speed_m_s": 0.2}, "checks": [{"kind": "allowed_forces"}]}
    both = r"^scenario.json:4:\d+: model: .*a.xml:\d+:\d+: hull:volum: is no parameter"
    with pytest.raises(ScenarioError, match=both):
        cube_sim.fly(load_mapping(given))


def test_what_is_given_to_it_is_not_the_files(tmp_path):
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(CUBE, {"hull:volume": -1.0})
    assert caught.value.place == ""
    assert str(caught.value).startswith(f"{CUBE}: hull:volume: is -1")


def test_an_accent_of_another_encoding_hides_nothing(tmp_path):
    text = TEXT.replace("<worldbody>", "<!-- \xe9 --><foo/><worldbody>", 1)
    (tmp_path / "a.xml").write_bytes(text.encode("latin-1", errors="replace"))
    with pytest.raises(ModelError, match=r"a\.xml:\d+:\d+: .*foo"):
        cube_sim.load_model(tmp_path / "a.xml")


@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
def test_everything_with_a_name_is_found_in_every_model(path):
    model, lines = cube_sim.load_model(path), path.read_text().splitlines()
    names = [model.numeric(i).name for i in range(model.nnumeric - 1)]
    names += [*hull_names(model), *(model.actuator(i).name for i in range(model.nu))]
    found = [place_of(path, name) for name in names]
    assert None not in found
    for name, place in zip(names, found, strict=True):
        assert place.attributes["name"] == name
        assert lines[place.line - 1][place.column - 1 :].startswith(f"<{place.tag}")
    assert len({*names}) == len(names)
    assert len([*elements_of(path)]) > len(names)
