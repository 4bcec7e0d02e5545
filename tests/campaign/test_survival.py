"""Every loss of one, two or three thrusters, flown, against what the analysis says of it beforehand."""

from __future__ import annotations

import pytest
from support.places import REPO

from cube_sim.actuation import PathRequirements, survivability
from cube_sim.campaign.sampling import count
from cube_sim.campaign.sweep import sweep
from cube_sim.mission.hull import flown_hull
from cube_sim.scenario import load

SURVIVAL = REPO / "benchmarks" / "survival.yaml"


def test_it_is_every_loss_of_up_to_three():
    assert count(load(SURVIVAL)) == 8 + 28 + 56


@pytest.mark.campaign
def test_what_the_analysis_expects_to_follow_follows(tmp_path):
    loaded = load(SURVIVAL)
    vehicle = flown_hull(loaded).vehicle
    table = survivability(
        vehicle.actuation_matrix,
        vehicle.thrusters.limits,
        names=vehicle.thrusters.names,
        hull=vehicle.dynamics,
        most=3,
        requirements=PathRequirements(speed_m_s=loaded.scenario.guidance.speed_m_s),
    )
    expected = {"+".join(case.lost): case.verdict.follows for case in table.cases if case.lost}
    rows = sweep(loaded, tmp_path / "out").rows.to_pylist()
    flown = {row["lost_thrusters"]: row["verdict"] == "PASS" for row in rows}
    assert flown == expected
    assert max(row["check.cross-track RMS after recovery.value"] for row in rows) <= 0.011
