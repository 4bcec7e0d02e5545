"""Several vehicles in one water: each flies as it flies alone, to the bit, and what joins them is said."""

import numpy as np
import pytest
from support.fleets import PAIR, fly, loaded_fleet, write
from support.places import MODELS

from cube_sim.errors import ScenarioError
from cube_sim.flight import FleetLoop, Loop, prepared, prepared_fleet, vehicle_loop
from cube_sim.recording.signal_store import SignalStore

EVENTFUL = PAIR.replace(
    "  leader:\n",
    "  leader:\n"
    "    events:\n"
    "      - {kind: thrusters, at_s: 3, thrusters: [T1, T4], state: dead}\n"
    "      - {kind: force, at_s: 5, for_s: 2, force_N: [5, 9, 0], site: T1}\n"
    "    telemetry: {noise_N: 0.3}\n",
).replace(
    "  follower:\n",
    "  follower:\n"
    "    navigation: {}\n"
    "    battery: {capacity_Wh: 50, open_circuit_V: [12.8, 16.8], resistance_ohm: 0.04}\n",
)
MORE = (
    "  rov:\n"
    "    model: {rov}\n"
    "    path: {{type: line, start_m: [0, -4, -5], end_m: [6, -4, -5]}}\n"
    "    initial: {{position_m: [0, -4, -5]}}\n"
    "    thrusters: {{dead_zone_N: [-1, 1]}}\n"
)


def alone(loaded):
    """The flight of a vehicle of a fleet, with nobody beside it."""
    mission = prepared(loaded)
    store = SignalStore(mission.channels)
    loop = Loop(mission, store)
    loop.fly_to_its_end()
    return store


def assert_same(store, name, single):
    for signal, rows in single.signals.items():
        assert store.signals[f"{name}/{signal}"].tobytes() == rows.tobytes(), signal
    said = [
        (line.t, line.level, line.text.removeprefix(f"{name}: ")) for line in store.lines if f"{name}: " in line.text
    ]
    assert said == [(line.t, line.level, line.text) for line in single.lines]


@pytest.mark.flight
def test_far_apart_each_flies_what_it_flies_alone_to_the_bit(tmp_path):
    from support.places import MODELS

    text = EVENTFUL.replace(
        "checks:\n  - {kind: dist", MORE.format(rov=MODELS / "bluerov2_heavy.xml") + "checks:\n  - {kind: dist"
    )
    loaded = loaded_fleet(write(tmp_path, text))
    loop, store = fly(loaded)
    assert not loop.ended
    for name, one in loaded.vehicles.items():
        assert_same(store, name, alone(one))


OWN_FORCES = f"""\
schema_version: 1
name: surveyors
duration_s: 16
seed: 4
current_m_s: [0.05, -0.03, 0]
guidance: {{speed_m_s: 1.5}}
parameters: {{"water:density": [1000.0]}}
path: {{type: line, start_m: [0, 0, -20], end_m: [200, 0, -20]}}
model: {MODELS / "nps_auv2.xml"}
vehicles:
  cube:
    model: {MODELS / "cube.xml"}
    guidance: {{speed_m_s: 0.3}}
    initial: {{position_m: [0, 60, -20]}}
    path: {{type: line, start_m: [0, 60, -20], end_m: [20, 60, -20]}}
  first:
    initial: {{position_m: [0, 4, -20], velocity_m_s: [1.5, 0, 0]}}
    checks: [{{kind: allowed_forces}}]
  second:
    path: {{type: line, start_m: [0, 30, -20], end_m: [200, 30, -25]}}
    initial: {{position_m: [0, 33, -21], velocity_m_s: [1.3, 0, 0]}}
  remus:
    model: {MODELS / "remus100.xml"}
    path: {{type: line, start_m: [0, -30, -20], end_m: [200, -30, -20]}}
    initial: {{position_m: [0, -28, -20], velocity_m_s: [1.5, 0, 0]}}
    events: [{{kind: fins, at_s: 4, fins: [rudder], state: jammed, angle_deg: 6}}]
"""


@pytest.mark.flight
def test_forces_that_read_commands_fly_side_by_side_as_alone(tmp_path):
    """Two NPS AUV II, whose race reads their propellers and planes, behind a CUBE and before a REMUS 100."""
    loaded = loaded_fleet(write(tmp_path, OWN_FORCES))
    loop, store = fly(loaded)
    assert not loop.ended
    for name, one in loaded.vehicles.items():
        single, compared = alone(one), 0
        for signal, rows in single.signals.items():
            together = store.signals[f"{name}/{signal}"]
            np.testing.assert_allclose(together, rows, rtol=0.0, atol=1e-12 * max(1.0, np.abs(rows).max()))
            compared += 1
        assert compared > 10
    race = np.abs(store.signals["second/fins.deflection"][:, 1:]).max()
    assert race > 0.01
    assert any("rudder" in line.text and "it seems" in line.text for line in store.lines)  # found, as alone


@pytest.mark.flight
def test_one_in_the_block_flies_as_without_it(tmp_path):
    block = PAIR.partition("  follower:")[0] + "    seed: 4\n"
    loaded = loaded_fleet(write(tmp_path, block))
    _, store = fly(loaded)
    assert_same(store, "leader", alone(loaded.vehicles["leader"]))


@pytest.mark.flight
def test_python_and_compiled_code_fly_the_same(tmp_path, monkeypatch):
    loaded = loaded_fleet(write(tmp_path, EVENTFUL))
    _, compiled = fly(loaded)
    with monkeypatch.context() as patch:
        patch.setattr(vehicle_loop, "begin_ticks", lambda *_: None)
        _, python = fly(loaded)
    for signal, rows in compiled.signals.items():
        assert rows.tobytes() == python.signals[signal].tobytes(), signal
    assert compiled.lines == python.lines


@pytest.mark.flight
def test_distances_are_those_of_the_poses(tmp_path):
    _, store = fly(loaded_fleet(write(tmp_path)))
    signals = store.signals
    apart = signals["leader/pose.position"][:, 1:] - signals["follower/pose.position"][:, 1:]
    found = signals["distance.leader_to_follower"]
    assert np.array_equal(found[:, 0], signals["leader/pose.position"][:, 0])
    assert np.allclose(found[:, 1], np.sqrt((apart**2).sum(axis=1)), rtol=1e-15)


@pytest.mark.flight
def test_hulls_that_meet_push_each_other_and_the_log_says_so(tmp_path):
    text = PAIR.replace(
        "path: {type: circle, centre_m: [0, 5, -5], radius_m: 2}",
        "path: {type: line, start_m: [6, 0, -5], end_m: [0, 0, -5]}",
    ).replace("initial: {position_m: [2, 4, -5]}", "initial: {position_m: [4, 0, -5], attitude_deg: [0, 0, 180]}")
    loaded = loaded_fleet(write(tmp_path, text.replace("[0, 0.2, -5]", "[0, 0, -5]")))
    _, store = fly(loaded)
    touches = [line for line in store.lines if line.text == "leader and follower touch"]
    assert touches
    assert touches[0].level == "WARNING"
    met = round(touches[0].t / 0.02)
    nearest = store.signals["distance.leader_to_follower"][:, 1]
    assert nearest.min() > 0.45  # edges of half a metre do not go through each other
    single = alone(loaded.vehicles["leader"]).signals["pose.position"]
    together = store.signals["leader/pose.position"]
    assert np.array_equal(single[:met], together[:met])
    assert np.abs(single[met:] - together[met:]).max() > 0.1


@pytest.mark.flight
def test_the_current_is_one_for_all_and_changes_for_all(tmp_path):
    text = PAIR + "events: [{kind: current, at_s: 5, current_m_s: [0, 0.2, 0]}]\n"
    _, store = fly(loaded_fleet(write(tmp_path, text)))
    for name in ("leader", "follower"):
        water = store.signals[f"{name}/water.current"]
        assert (water[water[:, 0] < 4.99, 1:] == [0.1, 0, 0]).all()
        assert (water[water[:, 0] > 5.01, 1:] == [0, 0.2, 0]).all()
    assert [line.text for line in store.lines if "current" in line.text] == ["the current is now [0.0, 0.2, 0.0] m/s"]


@pytest.mark.flight
def test_what_ends_the_flight_is_said_with_the_name(tmp_path):
    (tmp_path / "law.py").write_text(
        "def make(setup):\n"
        "    ticks = []\n"
        "    def law(aim):\n"
        "        ticks.append(aim)\n"
        "        return setup.dynamics.total_mass @ aim.error / (len(ticks) < 100)\n"
        "    return law\n"
    )
    text = PAIR.replace("  follower:\n", "  follower:\n    control: {law: {python: law.py:make}}\n")
    loop, store = fly(loaded_fleet(write(tmp_path, text)))
    assert loop.ended.startswith("follower: ")
    assert 1.9 < loop.time_s < 2.1
    assert store.lines[-1].level == "ERROR"
    assert store.lines[-1].text.startswith("follower: ")
    assert loop.ended_early is not None


@pytest.mark.flight
def test_a_condition_of_one_vehicle_stops_all_and_is_said_with_its_name(tmp_path):
    stop = "    stop: [{kind: signal, signal: target.arc_length, above: 1.0, verdict: pass}]\n"
    loop, store = fly(loaded_fleet(write(tmp_path, PAIR.replace("  follower:\n", f"  follower:\n{stop}"))))
    assert loop.stopped is not None
    assert loop.stopped.reason.startswith("follower: ")
    assert store.lines[-1].text.startswith("follower: ")
    ends = {name: rows[-1, 0] for name, rows in store.signals.items() if name.endswith("pose.position")}
    assert set(ends.values()) == {loop.time_s}
    assert loop.time_s < 12.0


@pytest.mark.flight
@pytest.mark.parametrize("first", ["leader", "follower"])
def test_own_code_sees_the_others_as_they_were_at_the_beginning_of_the_tick(tmp_path, first):
    (tmp_path / "law.py").write_text(
        "def make(setup, log):\n"
        "    def law(aim):\n"
        "        assert list(setup.others) == ['leader']\n"
        "        seen = setup.others['leader'].position\n"
        "        with open(log, 'a') as file:\n"
        "            print(aim.time, *seen.tolist(), file=file)\n"
        "        seen[:] = 0.0\n"
        "        return setup.dynamics.total_mass @ (0.1 * aim.velocity_error)\n"
        "    return law\n"
    )
    log, of_several = tmp_path / "seen.txt", "checks:\n  - {kind: dist"
    own = f"    control: {{law: {{python: law.py:make, options: {{log: {log}}}}}}}\n"
    top, _, rest = PAIR.partition("  leader:\n")
    leader, _, rest = rest.partition("  follower:\n")
    follower, _, checks = rest.partition(of_several)
    blocks = {"leader": f"  leader:\n{leader}", "follower": f"  follower:\n{own}{follower}"}
    second = next(name for name in blocks if name != first)
    _, store = fly(loaded_fleet(write(tmp_path, f"{top}{blocks[first]}{blocks[second]}{of_several}{checks}")))
    rows = store.signals["leader/pose.position"]
    seen = np.loadtxt(log)[-len(rows) :]  # it is asked once before the flight
    assert np.array_equal(seen[:, 1:], rows[:, 1:])


def test_what_one_vehicle_cannot_be_asked_is_said_where_it_stands(tmp_path):
    current = PAIR.replace(
        "  leader:\n", "  leader:\n    events: [{kind: current, at_s: 5, current_m_s: [0, 0.2, 0]}]\n"
    )
    with pytest.raises(ScenarioError, match=r"pair.yaml:11:14: vehicles.leader.events.0: changes the water of all"):
        prepared_fleet(loaded_fleet(write(tmp_path, current)))
    thruster = PAIR.replace(
        "  leader:\n", "  leader:\n    events: [{kind: thrusters, at_s: 5, thrusters: [T9], state: dead}]\n"
    )
    with pytest.raises(
        ScenarioError, match=r"vehicles.leader.events.0.thrusters.0: no thruster 'T9'; the model has T1"
    ):
        prepared_fleet(loaded_fleet(write(tmp_path, thruster)))
    signal = PAIR.replace("follower/path_error.cross_track", "follower/path_error.crosstrack")
    with pytest.raises(ScenarioError, match=r"checks.1.signal: no signal 'follower/path_error.crosstrack' is recorded"):
        prepared_fleet(loaded_fleet(write(tmp_path, signal)))


@pytest.mark.filterwarnings("ignore:Attach conflict")
def test_vehicles_of_one_model_with_several_hulls_share_it(tmp_path):
    import mujoco
    from support.places import MODELS

    both = mujoco.MjSpec()
    both.compiler.conflict = mujoco.mjtConflict.mjCONFLICT_MERGE
    for name in ("a_", "b_"):
        both.attach(mujoco.MjSpec.from_file(str(MODELS / "cube.xml")), prefix=name, frame=both.worldbody.add_frame())
    both.compile()
    (tmp_path / "two.xml").write_text(both.to_xml())
    text = PAIR.replace(str(MODELS / "cube.xml"), "two.xml")
    text = text.replace("  leader:\n", "  leader:\n    vehicle: a_hull\n").replace(
        "  follower:\n", "  follower:\n    vehicle: b_hull\n"
    )
    mission = prepared_fleet(loaded_fleet(write(tmp_path, text)))
    assert mission.model.nbody == 3
    assert [one.vehicle.name for one in mission.missions.values()] == ["a_hull", "b_hull"]
    assert mission.missions["follower"].vehicle.thrusters.names[0] == "b_T1"
    assert isinstance(FleetLoop(mission, SignalStore(mission.channels)), FleetLoop)


def test_models_in_waters_of_different_density_are_told_which_and_what_to_write(tmp_path):
    text = PAIR.replace("  follower:\n", f"  follower:\n    model: {MODELS / 'rov6.xml'}\n")
    line = text.splitlines().index(f"    model: {MODELS / 'rov6.xml'}") + 1
    with pytest.raises(ScenarioError) as refused:
        prepared_fleet(loaded_fleet(write(tmp_path, text)))
    (found,) = refused.value.mistakes
    said = "water:density is 1025 kg/m^3 in rov6.xml of follower, 1000 kg/m^3 in cube.xml of leader: there is one water"
    assert found.startswith(f"{tmp_path}/pair.yaml:{line}:12: vehicles.follower.model: {said}")
    way_out = found.partition("at the top of the file, ")[2]
    prepared_fleet(loaded_fleet(write(tmp_path, f"{way_out}\n{text}")))
