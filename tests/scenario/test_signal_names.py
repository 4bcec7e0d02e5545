"""A column that is written behind a signal is told as the component that it means."""

import pytest
import yaml
from support.places import HELIX

from cube_sim.errors import ScenarioError
from cube_sim.scenario import load


def with_check(tmp_path, **keys):
    mission = yaml.safe_load(HELIX.read_text())
    mission["model"] = str((HELIX.parent / mission["model"]).resolve())
    mission["checks"] = [{"kind": "signal", "statistic": "max", "at_most": 1.0, **keys}]
    (tmp_path / "mission.yaml").write_text(yaml.safe_dump(mission))
    return tmp_path / "mission.yaml"


@pytest.mark.parametrize(
    ("signal", "told"),
    [
        ("pose.position.z", "write signal: pose.position, component: 2"),
        ("pose.position[1]", "write signal: pose.position, component: 1"),
        ("pose.position.0", "write signal: pose.position, component: 0"),
        ("pose.quaternion.w", "write signal: pose.quaternion, component: 0"),
        ("pose.position.up", "write signal: pose.position, component: <column, from 0>"),
    ],
)
@pytest.mark.parametrize("key", ["signal", "minus"])
def test_a_column_behind_a_signal_is_told_as_a_component(key, signal, told, tmp_path):
    file = with_check(tmp_path, **{"signal": "pose.position", key: signal})
    with pytest.raises(ScenarioError) as raised:
        load(file)
    (line,) = str(raised.value).splitlines()
    assert line.startswith(f"{file}:")
    assert f"must be channel.field, got '{signal}'" in line
    assert line.endswith(told)


def test_its_component_is_taken(tmp_path):
    load(with_check(tmp_path, signal="pose.position", component=2))
