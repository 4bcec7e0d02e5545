"""How soon and how closely vehicles come to a path with one approach gain and another, and with the default.

    python benchmarks/approach_gains.py --vehicles cube torpedo infante

Each vehicle of `tests/support/catalogue` starts beside a level sinusoid in a current it does not know, and flies it
with `guidance.approach_gain_per_m` of each value and with none. The planar law is flown from farther off as well,
turned away, with wrong knowledge. Says when the cross-track error is within 5 cm for good, and its RMS from 60 s on.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tests")]

from support.catalogue.vehicles import catalogue  # noqa: E402

import cube_sim  # noqa: E402

GAINS = (0.25, 0.5, 1.0, 2.0, None)
"""[1/m]; None is the default."""
WITHIN_M = 0.05
FREE = ["bluerov2_heavy", "bluerov2_vectored", "cube", "jack", "rexrov"]
POINTING = ["torpedo", "torpedo_four_fins", "three_low_astern", "four_all_astern", "drawn3_0"]
DURATION_S, JUDGED_FROM_S = 100.0, 60.0


def cases(planar: bool) -> list[dict[str, Any]]:
    """The flights of a vehicle, gains apart."""
    if not planar:
        return [{"guidance.speed_m_s": speed} for speed in (0.15, 0.4)]
    turned = [
        (-120.0, 1.2, [0.0, 0.0, 0.0], 1.0),
        (60.0, 0.9, [0.1, 0.3, 0.0], 1.0),
        (150.0, 1.6, [-0.2, 0.1, 0.0], 1.3),
    ]
    near = [{"guidance.speed_m_s": speed} for speed in (1.0, 1.5)]
    return near + [
        {
            "initial.position_m": [0.0, 6.0, -20.0],
            "initial.attitude_deg": [0.0, 0.0, yaw],
            "guidance.speed_m_s": speed,
            "current_m_s": current,
            "knowledge.drag": drag,
        }
        for yaw, speed, current, drag in turned
    ]


def scenario(model: Path, planar: bool) -> dict[str, Any]:
    """Beside a sinusoid."""
    return {
        "schema_version": 1,
        "name": "approach_gains",
        "description": "A sinusoid, from beside it.",
        "model": str(model),
        "seed": 1,
        "duration_s": DURATION_S,
        "current_m_s": [0.02, 0.05, 0.0],
        "path": {
            "type": "sinusoid",
            "start_m": [0.0, 0.0, -20.0],
            "heading_deg": 0.0,
            "amplitude_m": 6.0 if planar else 2.0,
            "wavelength_m": 60.0 if planar else 30.0,
            "periods": 6.0 if planar else 4.0,
        },
        "initial": {"position_m": [0.0, 2.0, -20.0], "velocity_m_s": [0.5 if planar else 0.0, 0.0, 0.0]},
        "guidance": {"speed_m_s": 0.4, "stop_at_end": False},
        "checks": [{"kind": "allowed_forces"}],
    }


def main() -> None:
    """Fly and say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--vehicles", nargs="+", default=[*FREE, *POINTING, "infante"], metavar="NAME", help="of the catalogue"
    )
    parser.add_argument("--threads", type=int, default=None, help="flights at a time")
    arguments = parser.parse_args()
    known = catalogue()
    if strange := [name for name in arguments.vehicles if name not in known]:
        parser.error(f"no vehicle {strange[0]!r} in the catalogue")
    print(f"{'vehicle':24s}{'m/s':>6s}{'gain 1/m':>10s}{'within 5 cm s':>15s}{'RMS mm':>10s}")
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "model.xml"
        for name in arguments.vehicles:
            model.write_text(known[name].make())
            planar = name.startswith("infante")
            varied = [
                case | ({} if gain is None else {"guidance.approach_gain_per_m": gain})
                for case in cases(planar)
                for gain in GAINS
            ]
            signals = ["path_error.cross_track"]
            for outcome in cube_sim.fly_many(
                scenario(model, planar), varied, threads=arguments.threads, signals=signals
            ):
                t, error = outcome.signals[signals[0]].T
                outside = t[np.abs(error) > WITHIN_M]
                rms = float(np.sqrt(np.mean(error[t > JUDGED_FROM_S] ** 2)))
                gain = outcome.variation.get("guidance.approach_gain_per_m", "default")
                speed = outcome.variation["guidance.speed_m_s"]
                print(
                    f"{name:24s}{speed:6.2f}{gain!s:>10s}{outside.max(initial=0.0):15.1f}{1e3 * rms:10.2f}", flush=True
                )


if __name__ == "__main__":
    main()
