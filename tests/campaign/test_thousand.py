"""A thousand samples, flown in every way: not one byte is different."""

from __future__ import annotations

import pytest
from support.dask_cluster import cluster_of
from support.scenario_files import FLIGHT
from support.sweeps import swept, written

from cube_sim.campaign.folder import Shard

SAMPLES = """\
samples:
  count: 1000
  vary:
    guidance.speed_m_s: {distribution: uniform, low: 0.2, high: 0.6}
    current_m_s: {distribution: direction, high: 0.3, plane: any}
    initial.position_m: {distribution: normal, gives: offset, mean: [0, 0, 0], std: [0.1, 0.1, 0.1]}
    initial.attitude_deg.2: {distribution: uniform, low: -30, high: 30}
    parameters.hull:mass: {distribution: normal, gives: factor, mean: 1, std: 0.02, at_least: 0.9, at_most: 1.1}
    parameters.hull:added_mass: {distribution: log_normal, gives: factor, median: 1, log_std: 0.1}
    knowledge.drag: {distribution: sobol, low: 0.7, high: 1.3}
    control.faults: {distribution: choice, values: [diagnosed, told, ignored], weights: [3, 1, 1]}
  lost_thrusters: {losses: [0, 1, 2, 3], choose: random, at_s: 1, until_s: 4}
"""


@pytest.mark.campaign
def test_every_way_of_flying_leaves_the_same_bytes(tmp_path):
    file = written(tmp_path, SAMPLES, FLIGHT.replace("duration_s: 0.5", "duration_s: 6"))
    ways = {
        "one by one": {"workers": 1},
        "threads": {"workers": 3},
        "processes": {"workers": 2, "workers_as": "processes"},
    }
    flown = {name: swept(file, tmp_path / name, **options) for name, options in ways.items()}
    with cluster_of(tmp_path, 2) as (address, _):
        flown["cluster"] = swept(file, tmp_path / "cluster", cluster=address)
    for number in (1, 2, 3):
        swept(file, tmp_path / "parts", shard=Shard(number, 3))
    flown["parts"] = swept(file, tmp_path / "parts", resume=True)
    first = (flown["one by one"].folder / "rows.parquet").read_bytes()
    same = {name: (result.folder / "rows.parquet").read_bytes() == first for name, result in flown.items()}
    assert same == dict.fromkeys(flown, True)
    assert flown["threads"].rows.num_rows == 1000
    assert 0 < flown["threads"].count("FAIL") < 1000
