"""How a vehicle flies is said at the beginning, and what it will not do is a warning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.places import SCENARIOS

from cube_sim import Flight
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.mission.channels import polyline
from cube_sim.mission.way_of_flying import cannot_follow, depth_not_kept, steered_at_speed_only
from cube_sim.scenario import load

CHECKS = [{"kind": "allowed_forces"}]


def said(name: str, settings: dict | None = None) -> list[tuple[str, str]]:
    flight = Flight(SCENARIOS / f"{name}.yaml", {"duration_s": 1.0, "checks": CHECKS, "events": [], **(settings or {})})
    return [(line.level, line.text) for line in flight._store.lines]


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("cube_helix", "HOLONOMIC: the vehicle moves any way in any attitude (all six"),
        (
            "bluerov2_vectored_line",
            "TRIM: the vehicle moves any way, and roll or pitch are left to the water",
        ),
        (
            "jack_exact",
            "LEVEL: the vehicle moves any way in a level plane; heave, roll and pitch are left to the water",
        ),
        (
            "infante_line",
            "UNICYCLE: the vehicle turns its heading to point its thrust in a level plane; heave,",
        ),
        (
            "torpedo_line",
            "LINE: the vehicle turns its attitude to point thrust that is there in one direction",
        ),
    ],
)
def test_the_way_of_flying_is_told_once_and_is_no_warning(name, way):
    slow = {"guidance.speed_m_s": 0.3} if name.startswith("bluerov2") else {}  # below its critical speed
    lines = said(name, slow)
    assert [level for level, text in lines if text.startswith(way)] == ["INFO"]
    assert not any(level == "WARNING" for level, _ in lines)


def test_a_hull_in_a_level_plane_that_sinks_will_not_keep_its_depth():
    mission = prepare(load(SCENARIOS / "jack_exact.yaml"))
    able, level = mission.ability, polyline(mission.path)
    assert cannot_follow(able, level) is None
    hull = able.hold.hull
    assert hull is not None
    heavy = replace(able, hold=able.hold._replace(hull=replace(hull, displaced_mass=0.98 * hull.displaced_mass)))
    said = cannot_follow(heavy, level)
    assert said == (
        f"the depth of the path will not be kept: the hull sinks with {0.02 * hull.weight:.2g} N, and no thruster "
        "pushes up or down"
    )
    climbing = level + np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, 2.0], len(level))
    assert "the path rises or sinks by 2 m, and no thruster" in (cannot_follow(able, climbing) or "")


def test_nobody_with_heave_is_warned_of_its_depth():
    mission = prepare(load(SCENARIOS / "cube_helix.yaml"))
    assert depth_not_kept(mission.ability, mission.ability.whole, polyline(mission.path)) is None


@pytest.mark.parametrize(("path", "told"), [({"type": "point", "position_m": [5.0, 0.0, -5.0]}, 1), (None, 0)])
def test_a_hull_that_steers_by_fins_is_warned_of_a_point(path, told):
    settings = {} if path is None else {"path": path}
    lines = said("remus100_line", settings)
    assert sum(level == "WARNING" and "it cannot hold a point" in text for level, text in lines) == told


def test_a_hull_whose_thrusters_do_all_that_its_fins_do_holds_a_point():
    able = prepare(load(SCENARIOS / "remus100_line.yaml")).ability
    assert steered_at_speed_only(able) is not None
    everything = np.hstack([np.eye(6), -np.eye(6)])
    strong = np.array([[0.0, 0.0, 0.0, 50.0]] * 12)
    assert steered_at_speed_only(replace(able, A=everything, limits=strong)) is None


def test_a_fin_is_told_from_a_thruster_where_a_thruster_is_to_fail():
    failing = {"events": [{"at_s": 0.5, "kind": "thrusters", "thrusters": ["rudder"], "state": "dead"}]}
    with pytest.raises(ScenarioError, match=r"no thruster 'rudder'.*; 'rudder' turns a fin, which fails by"):
        prepare(load(SCENARIOS / "remus100_line.yaml", failing))
