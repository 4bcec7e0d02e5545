"""Error against time step: the compiled water against an independent integration of Fossen's equations.

    python benchmarks/accuracy.py [--svg FILE]

A tumbling body with random full added mass (largest eigenvalue of M_RB^-1 M_A: 3), full linear and quadratic damping,
offset centres and a current flies for 3 s. The reference is DOP853 at a relative tolerance of 1e-12
(`tests/support/water_bodies.py`). "lagged" is what a force -M_A qacc of the step before would do to the same body.
"""

from __future__ import annotations

import argparse
import sys
from math import floor, isfinite, log10
from pathlib import Path

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.water_bodies import Body, flown, fossen, get_state, random_body, reference, set_state, tumbling

DURATION_S = 3.0
STEPS_S = (0.02, 0.01, 0.005, 0.0025, 0.00125, 0.000625)
COLOURS = {"RK4": "#0a6ebd", "Euler": "#c2410c", "implicitfast": "#6d28d9", "lagged": "#6b7280"}


def lagged(body: Body, start: np.ndarray, timestep: float) -> float:
    """Position error of Euler steps on M_RB alone, with M_A times the acceleration of the step before as a force."""
    state, before = start.copy(), np.zeros(6)
    for _ in range(round(DURATION_S / timestep)):
        derivative = fossen(body, state)
        wanted = (body.rigid + body.added) @ derivative[7:]
        now = np.linalg.solve(body.rigid, wanted - body.added @ before)
        before, derivative[7:] = now, now
        state = state + timestep * derivative
        state[3:7] /= np.linalg.norm(state[3:7])
        if not np.all(np.isfinite(state)) or np.abs(state).max() > 1e6:
            return float("inf")
    return float(np.abs(state[:3] - reference(body, start, DURATION_S)[:3]).max())


def errors(body: Body, start: np.ndarray) -> dict[str, list[float]]:
    """Largest position error [m] after the flight, per integrator and step."""
    expected = reference(body, start, DURATION_S)[:3]
    found = {
        name: [float(np.abs(flown(body.model(name, h), start, DURATION_S)[:3] - expected).max()) for h in STEPS_S]
        for name in ("RK4", "Euler", "implicitfast")
    }
    with np.errstate(all="ignore"):
        found["lagged"] = [lagged(body, start, h) for h in STEPS_S]
    return found


def figure(results: dict[str, list[float]]) -> str:
    """A log-log chart as SVG."""
    width, height, left, bottom, top, right = 640, 400, 74, 52, 18, 150
    x0, x1 = log10(min(STEPS_S)) - 0.1, log10(max(STEPS_S)) + 0.1
    finite = [e for values in results.values() for e in values if isfinite(e)]
    y0, y1 = floor(log10(min(finite))), floor(log10(max(finite))) + 1

    def x(step: float) -> float:
        return left + (log10(step) - x0) / (x1 - x0) * (width - left - right)

    def y(error: float) -> float:
        return height - bottom - (log10(error) - y0) / (y1 - y0) * (height - bottom - top)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
        'font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for decade in range(y0, y1 + 1, 2):
        at = y(10.0**decade)
        parts.append(f'<line x1="{left}" x2="{width - right}" y1="{at:.1f}" y2="{at:.1f}" stroke="#e5e7eb"/>')
        parts.append(f'<text x="{left - 8}" y="{at + 4:.1f}" text-anchor="end">1e{decade}</text>')
    for step in STEPS_S:
        at = x(step)
        parts.append(f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{top}" y2="{height - bottom}" stroke="#f3f4f6"/>')
        parts.append(f'<text x="{at:.1f}" y="{height - bottom + 18}" text-anchor="middle">{1e3 * step:g}</text>')
    for name, values in results.items():
        points = [(x(h), y(e)) for h, e in zip(STEPS_S, values, strict=True) if isfinite(e)]
        if not points:
            continue
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[name]}" stroke-width="2"/>')
        parts += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{COLOURS[name]}"/>' for a, b in points]
    for i, (name, values) in enumerate(results.items()):
        text = name if any(map(isfinite, values)) else f"{name}: diverges"
        at = top + 20 + 20 * i
        parts.append(f'<rect x="{width - right + 14}" y="{at - 9}" width="12" height="10" fill="{COLOURS[name]}"/>')
        parts.append(f'<text x="{width - right + 32}" y="{at}">{text}</text>')
    middle = left + (width - left - right) / 2
    parts.append(f'<text x="{middle}" y="{height - 12}" text-anchor="middle">time step [ms]</text>')
    parts.append(
        f'<text transform="translate(16 {height / 2}) rotate(-90)" text-anchor="middle">'
        f"position error after {DURATION_S:g} s [m]</text>"
    )
    return "\n".join([*parts, "</svg>", ""])


def kirchhoff_drift(timestep: float) -> dict[str, float]:
    """Relative drift of energy, |p| and p.h over 20 s of tumbling in an ideal fluid."""
    from dataclasses import replace

    from support.water_bodies import DENSITY

    rng = np.random.default_rng(0)
    body = random_body(rng, 3.0)
    zero = np.zeros((6, 6))
    body = replace(body, volume=body.mass / DENSITY, cb=body.cg, linear=zero, quadratic=zero, current=(0.0, 0.0, 0.0))
    M = body.rigid + body.added
    model = body.model(timestep=timestep)
    data = mujoco.MjData(model)
    set_state(data, tumbling(rng))

    def invariants() -> np.ndarray:
        nu = get_state(data)[7:]
        p, h = M[:3] @ nu, M[3:] @ nu
        return np.array([0.5 * nu @ M @ nu, np.linalg.norm(p), p @ h])

    first = invariants()
    mujoco.mj_step(model, data, nstep=round(20.0 / timestep))
    return dict(zip(("energy", "|p|", "p.h"), np.abs(invariants() / first - 1.0).tolist(), strict=True))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--svg", type=Path, help="where to write the chart")
    options = parser.parse_args()
    rng = np.random.default_rng(3)
    body, start = random_body(rng, 3.0), tumbling(rng)
    results = errors(body, start)
    print(f"position error [m] after {DURATION_S:g} s\n{'step [ms]':>10}" + "".join(f"{name:>14}" for name in results))
    for i, h in enumerate(STEPS_S):
        print(f"{1e3 * h:10g}" + "".join(f"{values[i]:14.1e}" for values in results.values()))
    drift = kirchhoff_drift(0.01)
    print("\nrelative drift over 20 s of tumbling, RK4 at 10 ms: ", end="")
    print(", ".join(f"{name} {value:.1e}" for name, value in drift.items()))
    if options.svg:
        options.svg.write_text(figure(results))


if __name__ == "__main__":
    main()
