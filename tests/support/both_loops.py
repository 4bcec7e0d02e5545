"""A flight by the compiled loop and by the one in Python, side by side."""

from __future__ import annotations

from cube_sim.flight import Flight, loop


def flown(scenario, settings, compiled, monkeypatch, **own):
    """A flight to its end, its signals and sentences, and how many of its ticks compiled code flew."""
    one, ticks, take_over = Flight(scenario, settings, **own), [0], loop.take_over

    def counted(done, *others):
        ticks[0] += done.ticks
        return take_over(done, *others)

    with monkeypatch.context() as patch:
        patch.setattr(loop, "take_over", counted)
        if not compiled:
            patch.setattr(loop, "begin_ticks", lambda *_: None)
        one.fly_to_its_end()
    return one, ticks[0]


def assert_same_flight(scenario, settings, monkeypatch, **own):
    """Both loops do the same; the share of ticks that compiled code flew."""
    (a, compiled), (b, none) = (flown(scenario, settings, how, monkeypatch, **own) for how in (True, False))
    assert none == 0
    assert a.tick == b.tick
    assert a.ended == b.ended
    assert a.log == b.log
    for name, rows in a.signals.items():
        assert rows.tobytes() == b.signals[name].tobytes(), name
    return compiled / a.tick
