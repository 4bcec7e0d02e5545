"""Bladders and tanks of the MJCF: against closed forms, and against equations of motion integrated independently."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support import plain_callbacks
from support.water_bodies import DENSITY

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.ballast import Ballast
from cube_sim.vehicle.vehicle import Vehicle

MASS, BELOW, G = 50.0, 0.03, 9.81
INERTIA = (0.6, 9.0, 9.2)
ADDED, DRAG, LINEAR = (
    (5.0, 60.0, 55.0, 0.5, 8.0, 7.0),
    (20.0, 200.0, 200.0, 4.0, 30.0, 30.0),
    (1.0, 3.0, 3.0, 0.5, 2, 2),
)
BLADDER, TANK = (0.4, 0.05, 0.02), (-0.3, -0.04, 0.03)
LAG_S, RATE = 0.5, 5e-5


def words(values) -> str:
    return " ".join(f"{float(value)!r}" for value in np.atleast_1d(values))


def text_of(
    added=ADDED, drag=DRAG, linear=LINEAR, below=BELOW, bladder=BLADDER, tank=TANK, kind="bladder tank", gravity=G,
    pump=f'dyntype="user" dynprm="{LAG_S} {RATE}" gainprm="0"', travel=None, more="", wind="0 0 0", size=0.05,
) -> str:  # fmt: skip
    """A hull that is neutral before its ballast is moved, with a bladder, a tank or both."""
    places = {"bladder": bladder, "tank": tank}
    ranges = {"bladder": "-1e-3 1e-3", "tank": "0 2e-3"} | (travel or {})
    says = {"bladder": ("ballast_displaces", 1.0), "tank": ("ballast_density", DENSITY)}
    kinds = kind.split()
    numerics = "".join(f'<numeric name="{k}:{says[k][0]}" data="{says[k][1]!r}"/>' for k in kinds)
    sites = "".join(f'<site name="{k}" pos="{words(places[k])}" size="{size}"/>' for k in kinds)
    pumps = "".join(f'<general name="{k}" site="{k}" {pump} ctrlrange="{ranges[k]}"/>' for k in kinds)
    return f"""<mujoco><option timestep="0.01" integrator="RK4" gravity="0 0 -{gravity}" wind="{wind}"/>
      <custom><numeric name="water:density" data="{DENSITY}"/>
        <numeric name="hull:volume" data="{MASS / DENSITY!r}"/>
        <numeric name="hull:added_mass" data="{words(added)}"/>
        <numeric name="hull:linear_damping" data="{words(linear)}"/>
        <numeric name="hull:quadratic_damping" data="{words(drag)}"/>{numerics}{more}</custom>
      <worldbody><body name="hull"><freejoint name="hull"/>
        <inertial pos="0 0 -{below}" mass="{MASS}" diaginertia="{words(INERTIA)}"/>{sites}</body></worldbody>
      <actuator>{pumps}</actuator></mujoco>"""


def model_of(**given) -> mujoco.MjModel:
    return cube_sim.load_model(mujoco.MjSpec.from_string(text_of(**given)))


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rate_of(wanted, volume):
    return np.clip((wanted - volume) / LAG_S, -RATE, RATE)


@pytest.mark.parametrize("kind", ["bladder", "tank"])
def test_depth_by_ballast_alone(kind):
    """A vertical line: (M + A + m) w' = -+rho g V - D w - D_q |w| w - V'+ rho w, with m = rho V in a tank."""
    model = model_of(kind=kind, bladder=(0, 0, 0), tank=(0, 0, 0))
    data = mujoco.MjData(model)
    data.ctrl[0] = 8e-4
    tank = kind == "tank"

    def slope(t, y):
        w, V = y[1:]
        Vdot = rate_of(8e-4, V)
        force = (-1.0 if tank else 1.0) * DENSITY * G * V - LINEAR[2] * w - DRAG[2] * abs(w) * w
        m = MASS + ADDED[2] + (DENSITY * V if tank else 0.0)
        return [w, (force - (DENSITY * max(Vdot, 0.0) * w if tank else 0.0)) / m, Vdot]

    truth = solve_ivp(slope, (0, 40), [0, 0, 0], method="DOP853", rtol=1e-12, atol=1e-14, max_step=0.05).y[:, -1]
    mujoco.mj_step(model, data, nstep=4000)
    assert data.qpos[2] == pytest.approx(truth[0], rel=1e-6)
    assert data.qvel[2] == pytest.approx(truth[1], rel=1e-6)
    assert data.act[0] == pytest.approx(truth[2], rel=1e-8)
    assert abs(truth[0]) > 4.0


@pytest.mark.parametrize("kind", ["bladder", "tank", "bladder tank"])
def test_six_degrees_of_freedom(kind):
    """Newton and Euler with the mass in the tank as a particle that hangs on the hull, in body axes, in a current."""
    current = np.array([0.2, -0.1, 0.05])
    model = model_of(kind=kind, wind=words(current))
    data = mujoco.MjData(model)
    wanted = [{"bladder": 6e-4, "tank": 1.1e-3}[k] for k in kind.split()]
    data.ctrl[:] = wanted
    data.qvel[:] = 0.3, -0.2, 0.1, 0.2, -0.3, 0.25
    M_A, r_G = np.diag(ADDED), np.array([0.0, 0.0, -BELOW])
    S_G = skew(r_G)
    M_RB = np.block([[MASS * np.eye(3), -MASS * S_G], [MASS * S_G, np.diag(INERTIA) - MASS * S_G @ S_G]])

    def coriolis(M, nu):
        p, h = np.split(M @ nu, 2)
        return np.r_[np.cross(nu[3:], p), np.cross(nu[:3], p) + np.cross(nu[3:], h)]

    def slope(t, y):
        q, nu, V = y[3:7], y[7:13], y[13:]
        w, x, yy, z = q / np.linalg.norm(q)
        R = np.array([
            [1 - 2 * (yy * yy + z * z), 2 * (x * yy - w * z), 2 * (x * z + w * yy)],
            [2 * (x * yy + w * z), 1 - 2 * (x * x + z * z), 2 * (yy * z - w * x)],
            [2 * (x * z - w * yy), 2 * (yy * z + w * x), 1 - 2 * (x * x + yy * yy)],
        ])  # fmt: skip
        down, v_c = R.T @ [0, 0, -G], R.T @ current
        nu_r = nu - np.r_[v_c, 0, 0, 0]
        rates = np.array([rate_of(a, b) for a, b in zip(wanted, V, strict=True)])
        M_T, F = np.zeros((6, 6)), np.zeros(6)
        for name, volume, rate in zip(kind.split(), V, rates, strict=True):
            r = np.array({"bladder": BLADDER, "tank": TANK}[name])
            if name == "bladder":
                f = -DENSITY * volume * down
            else:
                m, S = DENSITY * volume, skew(r)
                M_T += np.block([[m * np.eye(3), -m * S], [m * S, -m * S @ S]])
                f = m * down - DENSITY * max(rate, 0.0) * (nu_r[:3] + np.cross(nu[3:], r))
            F += np.r_[f, np.cross(r, f)]
        weight, lift = MASS * down, -MASS * down
        F += np.r_[weight + lift, np.cross(r_G, weight)]
        F -= np.array(LINEAR) * nu_r + np.array(DRAG) * np.abs(nu_r) * nu_r
        F -= coriolis(M_RB, nu) + coriolis(M_T, nu) + coriolis(M_A, nu_r)
        # M_A nu_r' with nu_r' = nu' + [w x v_c; 0]
        F -= M_A @ np.r_[np.cross(nu[3:], v_c), 0, 0, 0]
        nudot = np.linalg.solve(M_RB + M_A + M_T, F)
        omega = np.r_[0, nu[3:]]
        qdot = 0.5 * np.array([
            -q[1:] @ omega[1:], *(q[0] * omega[1:] + np.cross(q[1:], omega[1:])),
        ])  # fmt: skip
        return np.r_[R @ nu[:3], qdot, nudot, rates]

    start = np.r_[0, 0, 0, 1, 0, 0, 0, data.qvel, np.zeros(len(wanted))]
    given = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "max_step": 0.05}
    truth = solve_ivp(slope, (0, 30), start, **given).y[:, -1]
    model.opt.timestep = 0.005
    mujoco.mj_step(model, data, nstep=6000)
    assert data.qpos[:3] == pytest.approx(truth[:3], rel=1e-6, abs=1e-6)
    assert data.qpos[3:7] == pytest.approx(truth[3:7] / np.linalg.norm(truth[3:7]), abs=1e-6)
    R = data.xmat[1].reshape(3, 3)
    assert R.T @ data.qvel[:3] == pytest.approx(truth[7:10], abs=1e-6)
    assert data.qvel[3:] == pytest.approx(truth[10:13], abs=1e-6)


def test_what_comes_into_a_tank_brings_no_momentum():
    """Without drag and weight, in still water: (M + A + rho V) u stays; what is pumped out leaves with its own."""
    none = (0.0,) * 6
    model = model_of(kind="tank", tank=(0, 0, 0), drag=none, linear=none, gravity=0.0, below=0.0)
    data = mujoco.MjData(model)
    data.qvel[0], data.ctrl[0] = 0.7, 2e-3
    for _ in range(600):
        mujoco.mj_step(model, data)
        assert (MASS + ADDED[0] + DENSITY * data.act[0]) * data.qvel[0] == pytest.approx(55.0 * 0.7, rel=1e-9)
    assert data.act[0] > 2.9e-4
    speed, data.ctrl[0] = data.qvel[0], 0.0
    mujoco.mj_step(model, data, nstep=400)
    assert data.act[0] < 1.5e-4
    assert data.qvel[0] == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("volume", [2e-4, -7e-4])
def test_a_bladder_ahead_trims_the_nose(volume):
    """tan(theta) = rho V x / (M z - rho V z_b): the moments of lift and weight about the centre of buoyancy."""
    model = model_of(kind="bladder", bladder=(0.4, 0.0, 0.02), linear=(60.0,) * 6)
    data = mujoco.MjData(model)
    data.ctrl[0] = volume
    mujoco.mj_step(model, data, nstep=20000)
    R = data.xmat[1].reshape(3, 3)
    nose_up = np.arcsin(R[2, 0])
    # rising or sinking on its line, the drag acts at the origin and turns nothing, but for Munk's moment of w and u
    u, w = (R.T @ data.qvel[:3])[[0, 2]]
    munk = (ADDED[2] - ADDED[0]) * u * w
    arm = MASS * BELOW + DENSITY * volume * 0.02
    left = DENSITY * volume * G * 0.4 * np.cos(nose_up) - arm * G * np.sin(nose_up) - munk
    assert np.abs(data.qvel[3:]).max() < 1e-9
    assert left == pytest.approx(0.0, abs=1e-6)
    assert np.sign(nose_up) == np.sign(volume)


@pytest.mark.parametrize("height", [-0.2, -0.04, 0.0, 0.03, 0.06])
def test_a_bladder_fades_with_the_surface_and_a_tank_does_not(height):
    """By the share of a sphere of its site's size that is under water."""
    more = '<numeric name="water:surface" data="0"/>'
    pushed = []
    for kind in ("bladder", "tank"):
        model = model_of(kind=kind, more=more, bladder=(0, 0, 0), tank=(0, 0, 0), size=0.05)
        forces = []
        for volume in (0.0, 5e-4):
            data = mujoco.MjData(model)
            data.qpos[2], data.act[0], data.ctrl[0] = height, volume, volume
            mujoco.mj_forward(model, data)
            forces.append(data.qfrc_passive[2])
        pushed.append(forces[1] - forces[0])
    t = np.clip(height / 0.05, -1.0, 1.0)
    share = (1 - t) ** 2 * (2 + t) / 4
    assert pushed[0] == pytest.approx(share * DENSITY * G * 5e-4, abs=1e-12)
    assert pushed[1] == pytest.approx(-DENSITY * G * 5e-4, rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_callbacks_are_their_plain_python(seed):
    rng = np.random.default_rng(seed)
    model = model_of(more='<numeric name="water:surface" data="0.05"/>')
    data = mujoco.MjData(model)
    data.qpos[:3], data.qvel[:] = rng.normal(size=3) * 0.1, rng.normal(size=6)
    data.qpos[3:7] = rng.normal(size=4)
    data.act[:], data.ctrl[:] = rng.uniform([-1e-3, 0], [1e-3, 2e-3]), rng.uniform([-1e-3, 0], [1e-3, 2e-3])
    mujoco.mj_forward(model, data)
    compiled, inertia = data.qfrc_passive.copy(), data.M.copy()
    held = mujoco.get_mjcb_passive()
    mujoco.set_mjcb_passive(None)
    try:
        other = mujoco.MjData(model)
        other.qpos[:], other.qvel[:], other.act[:], other.ctrl[:] = data.qpos, data.qvel, data.act, data.ctrl
        mujoco.mj_forward(model, other)
        plain_callbacks.callbacks()["passive"](model._address, other._address)
    finally:
        mujoco.set_mjcb_passive(held)
    assert other.qfrc_passive.tobytes() == compiled.tobytes()
    assert other.M.tobytes() == inertia.tobytes()


def test_what_is_read_back():
    model = model_of()
    ballast = Vehicle.from_model(model).ballast
    assert isinstance(ballast, Ballast)
    assert ballast.names == ("bladder", "tank")
    assert ballast.lift_per_volume.tolist() == [DENSITY, -DENSITY]
    assert ballast.travel.tolist() == [[-1e-3, 1e-3], [0.0, 2e-3]]
    assert ballast.rate.tolist() == [RATE, RATE]
    cube_sim.set_parameters(model, {"tank:ballast_density": [1025.0]})
    again = Vehicle.from_model(model).ballast
    assert again is not None
    assert again.lift_per_volume.tolist() == [DENSITY, -1025.0]


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"pump": 'dyntype="filter" dynprm="1" gainprm="0"'}, "no pump"),
        ({"pump": 'dyntype="user" dynprm="1 1e-4" gainprm="1"'}, "no pump"),
        ({"pump": 'dyntype="user" dynprm="0 1e-4" gainprm="0"'}, "its lag"),
        ({"pump": 'dyntype="user" dynprm="1 0" gainprm="0"'}, "its rate"),
        ({"travel": {"tank": "-1e-3 1e-3"}}, "begins at 0"),
        ({"travel": {"bladder": "1e-4 1e-3"}}, "about 0"),
        ({"more": '<numeric name="nobody:ballast_density" data="1000"/>'}, "no site 'nobody'"),
        (
            {"travel": {"bladder": "0 1"}, "more": '<numeric name="bladder:ballast_density" data="-3"/>'},
            "not negative",
        ),
        ({"more": '<numeric name="hull:ballast_displaces" data="1"/>'}, "no site 'hull'"),
        ({"more": '<numeric name="tank:ballast_displaces" data="2"/>'}, "a share"),
        ({"more": '<numeric name="tank:ballast_displace" data="1"/>'}, "did you mean ballast_displaces"),
        ({"more": '<numeric name="tank.ballast_displaces" data="1"/>'}, "write tank:ballast_displaces"),
        (
            {"pump": 'dyntype="user" dynprm="1 1e-4" gainprm="0" actlimited="true" actrange="0 1e-4"'},
            "has the actrange",
        ),
        ({"pump": 'dyntype="user" dynprm="1 1e-4" gainprm="0" gear="3"'}, 'has gear "3 0 0 0 0 0"'),
        ({"pump": 'dyntype="user" dynprm="1 1e-4" gainprm="0" forcerange="-1 1"'}, "has a forcerange"),
        ({"more": '<numeric name="tank:fin_area" data="1"/><numeric name="tank:fin_lift_slope" data="3"/>'}, "one of"),
    ],
)
def test_one_line_says_what_is_wrong(given, word):
    with pytest.raises(ModelError) as told:
        model_of(**given)
    assert word in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("old", "new", "element", "told"),
    [
        ("bladder:ballast_displaces", "bladder:ballast_displace", "bladder:ballast_displace", "did you mean"),
        ("bladder:ballast_displaces", "blader:ballast_displaces", "blader:ballast_displaces", "no site 'blader'"),
        ("bladder:ballast_displaces", "bladder.ballast_displaces", "bladder.ballast_displaces", "has no colon"),
        ("bladder:ballast_displaces", "hull:ballast_displaces", "hull:ballast_displaces", "no site 'hull'"),
        ('name="tank" site="tank"', 'name="tank" site="tnak"', "tank", "no site 'tnak'; did you mean 'tank'?"),
    ],
)
def test_a_slip_of_the_pen_is_told_where_it_is(tmp_path, old, new, element, told):
    """The only number of a bladder, which makes it one: what the pump lacks is not what is wrong."""
    path = tmp_path / "a.xml"
    text = text_of()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    with pytest.raises(ModelError) as caught:
        cube_sim.load_model(path)
    assert caught.value.element == element
    assert told in caught.value.reason
    line, column = (int(each) for each in caught.value.place.split(":")[1:])
    assert new in path.read_text().splitlines()[line - 1][column - 1 :].partition(">")[0]


def test_an_actrange_as_wide_as_the_ctrlrange_is_none():
    model_of(kind="bladder", pump=f'dyntype="user" dynprm="1 {RATE}" gainprm="0" actlimited="true" actrange="-1 1"')
