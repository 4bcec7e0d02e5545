"""`cube-sim plot` as people call it: what is in the figure, that it is the same again, and what is refused."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from support.command_line import call
from support.own_code import scenario_with

import cube_sim
from cube_sim.report import colours, figure
from cube_sim.report.above_frame import write_names
from cube_sim.report.figure import save_figure
from cube_sim.report.figure_panels import Plot
from cube_sim.report.happenings import EVENT, Happening
from cube_sim.report.subject import Subject

TOLD = {
    "duration_s": 4.0,
    "events": [{"kind": "thrusters", "at_s": 2.0, "thrusters": ["T1"], "state": "dead"}],
    "checks": [
        {"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "at_most": 9.0},
        {"kind": "signal", "signal": "velocity.linear", "statistic": "max", "at_most": 5.0},
    ],
}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown")
    return cube_sim.run(scenario_with(folder, ""), TOLD, folder / "run", record="mcap").directory


@pytest.mark.flight
def test_the_usual_figure_is_written_beside_the_run(flown, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "plot", flown)
    file = flown.with_name("run.png")
    assert (code, out, err) == (0, f"{file}\n", "")
    with Image.open(file) as picture:
        assert picture.width == pytest.approx(170 / 25.4 * 300, abs=1)
        assert len(picture.convert("RGB").resize((200, 150)).getcolors(30_000)) > 50


@pytest.mark.flight
@pytest.mark.parametrize("width", [55, 85, 119, 120, 300])
@pytest.mark.parametrize("signals", [[], ["thrusters.force", "wrench.demanded", "path_error.cross_track"]])
def test_every_width_that_is_allowed_shows_curves_and_all_that_is_written(flown, monkeypatch, width, signals):
    made = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: made.append(self))
    subject = Subject(cube_sim.load_run(flown), "run", "#000")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        save_figure(subject, signals, flown / "a.png", width)
    (drawn,) = made
    mm = 25.4 / drawn.dpi
    for axes in drawn.axes:
        assert axes.bbox.width * mm > 15.0
        assert axes.bbox.height * mm > 10.0
        assert axes.get_tightbbox().x1 * mm < width + 0.5
        assert axes.get_tightbbox().x0 * mm > -0.5


@pytest.mark.flight
def test_a_width_without_room_is_one_line(flown, tmp_path, monkeypatch, capsys):
    file = tmp_path / "a.png"
    code, out, err = call(monkeypatch, capsys, "plot", flown, "--out", file, "--width-mm", "40")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("cube-sim plot: invalid value for '--width-mm': ")
    monkeypatch.setitem(figure._STYLE, "legend.fontsize", 40.0)
    code, out, err = call(monkeypatch, capsys, "plot", flown, "--out", file, "--width-mm", "55")
    told = "--width-mm 55: too narrow for what is written beside the curves\n"
    assert (code, out, err) == (2, "", told)
    assert not file.exists()


@pytest.mark.flight
@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_the_same_run_gives_the_same_bytes(flown, tmp_path, suffix, monkeypatch, capsys):
    files = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for file in files:
        assert call(monkeypatch, capsys, "plot", flown, "--out", file)[0] == 0
    one, other = (file.read_bytes() for file in files)
    assert one == other
    for stamp in (b"CreationDate", b"<dc:date>", b"tIME"):
        assert stamp not in one


@pytest.mark.flight
def test_curves_are_those_asked_for_with_their_units_limits_and_events(flown, tmp_path, monkeypatch):
    from matplotlib import figure as drawing

    made = []
    monkeypatch.setattr(drawing.Figure, "savefig", lambda self, *_, **__: made.append(self))
    run = cube_sim.load_run(flown)
    signals = ["path_error.cross_track", "thrusters.force", "pose.position.z"]
    save_figure(Subject(run, "run", "#000000"), signals, tmp_path / "a.pdf", 85.0, (1.0, 3.0))
    ((error, forces, height),) = [figure.axes for figure in made]
    assert error.get_ylabel() == "path error cross track [m]"
    assert (forces.get_ylabel(), height.get_ylabel()) == ("thrusters force [N]", "pose.position.z [m]")
    assert height.get_xlabel() == "time [s]"
    t, drawn = error.lines[0].get_data()
    rows = run.signals["path_error.cross_track"]
    rows = rows[(rows[:, 0] >= 1.0) & (rows[:, 0] <= 3.0)]
    assert (t.tolist(), drawn.tolist()) == (rows[:, 0].tolist(), rows[:, 1].tolist())
    assert [list(line.get_ydata()) for line in error.lines if line.get_label() == "max ≤ 9 m"] == [[9.0, 9.0]]
    assert [text.get_text() for text in error.texts] == ["T1: dead"]
    for axes in (error, forces):
        assert axes.get_legend().get_window_extent().y0 >= axes.get_window_extent().y1, "it hides nothing"
    assert height.get_legend() is None, "one curve, named beside its axis"
    for axes in (error, forces, height):
        assert 2.0 in [line.get_xdata()[0] for line in axes.lines]
    named = [line.get_label() for line in forces.lines if not line.get_label().startswith("_")]
    assert named == list(run.fields["thrusters.force"].columns)


@pytest.mark.flight
def test_a_code_is_drawn_by_names_and_a_limit_on_a_norm_not_beside_its_parts(flown, tmp_path, monkeypatch):
    from matplotlib import figure as drawing

    made = []
    monkeypatch.setattr(drawing.Figure, "savefig", lambda self, *_, **__: made.append(self))
    run = cube_sim.load_run(flown)
    save_figure(Subject(run, "run", "#000000"), ["allocation.status", "velocity.linear"], tmp_path / "a.png")
    ((status, velocity),) = [figure.axes for figure in made]
    codes = run.signals["allocation.status"][:, 1].astype(int)
    names = run.fields["allocation.status"].labels[codes.min() : codes.max() + 1]
    assert [text.get_text() for text in status.get_yticklabels()] == list(names)
    assert "max ≤ 5 m/s" not in velocity.get_legend_handles_labels()[1]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["path_error.cros_track"], "no signal 'path_error.cros_track'; did you mean path_error.cross_track?"),
        (["--out", "a.jpg"], "a.jpg: a figure is one of .png, .svg, .pdf"),
        (["pose"], "pose is a channel; its signals are pose.position, pose.quaternion"),
        (["--from-s", "500"], "--from-s 500: the run ends at 4 s"),
        (["--to-s", "nan"], "there is nothing to draw from 0 s to nan s"),
        (
            ["path.points"],
            "path.points has 1200 columns, 16 at most are told apart in one panel; name one of them: path.points.0/x",
        ),
        (["--from-s", "3", "--to-s", "2"], "there is nothing to draw from 3 s to 2 s"),
    ],
)
def test_mistakes_are_one_line(flown, arguments, said, monkeypatch, capsys):
    assert call(monkeypatch, capsys, "plot", flown, *arguments) == (2, "", f"{said}\n")


@pytest.mark.flight
def test_a_time_outside_the_run_is_cut_to_the_run(flown, tmp_path, monkeypatch, capsys):
    whole, cut = tmp_path / "whole.svg", tmp_path / "cut.svg"
    assert call(monkeypatch, capsys, "plot", flown, "--out", whole)[0] == 0
    code, _, err = call(monkeypatch, capsys, "plot", flown, "--from-s", "-1e9", "--to-s", "1e9", "--out", cut)
    assert (code, err, cut.read_bytes() == whole.read_bytes()) == (0, "", True)


@pytest.mark.flight
@pytest.mark.parametrize("width", [55, 170])
def test_a_figure_says_nothing_and_tells_its_curves_apart(flown, monkeypatch, width):
    """Of more curves than there are colours: as those of a vehicle with twelve thrusters."""
    made = []
    monkeypatch.setattr(Figure, "draw_without_rendering", lambda self: made.append(self))
    monkeypatch.setattr(Figure, "savefig", lambda *_, **__: warnings.warn("collapsed", UserWarning, stacklevel=1))
    rows = np.column_stack([np.arange(4.0), np.arange(4.0)])
    panel = Plot("force [N]", tuple((f"T{k}", rows) for k in range(colours.MOST_CURVES)))
    monkeypatch.setattr(figure, "panel_of", lambda *_: panel)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        save_figure(Subject(cube_sim.load_run(flown), "run", "#000"), ["any"], flown / "a.png", width)
    curves = [line for line in made[0].axes[0].get_lines() if line.get_label().startswith("T")]
    assert len({(line.get_color(), line.get_linestyle()) for line in curves}) == colours.MOST_CURVES == len(curves)


def test_names_of_events_do_not_meet():
    figure = Figure(figsize=(6.7, 2.0))
    axes = figure.add_subplot()
    axes.set_xlim(0.0, 100.0)
    told = [Happening(t, EVENT, text) for t, text in ((50.0, "T3: weak, 35 % of its force"), (60.0, "current " * 5))]
    write_names(figure, axes, [*told, Happening(95.0, EVENT, "T1: recovered")])
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in axes.texts]
    frame = axes.get_window_extent()
    assert len(boxes) == 3
    for k, box in enumerate(boxes):
        assert frame.x0 <= box.x0 < box.x1 <= frame.x1 + 1.0
        assert not any(box.overlaps(other) for other in boxes[:k])


def test_what_is_no_run_is_one_line(tmp_path, monkeypatch, capsys):
    told = f"{tmp_path}: is not the folder of a run: there is no run.mcap in it\n"
    assert call(monkeypatch, capsys, "plot", tmp_path) == (2, "", told)
