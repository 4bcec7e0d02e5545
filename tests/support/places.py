"""Where things stand in the repository."""

from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
MODELS = REPO / "models"
SCENARIOS = REPO / "scenarios"

MODEL_FILES = sorted(MODELS.glob("*.xml"))
STEERED_BY_FINS = ("remus100", "remus100_propeller", "nps_auv2")
"""Models that their fins steer: at the speeds of the catalogue, some 0.3 m/s, they fly nothing.

Their trials are those of `support.catalogue.steered`.
"""
FLOWN_MODEL_FILES = [path for path in MODEL_FILES if path.stem not in STEERED_BY_FINS]
WRITTEN_MODEL_FILES = [path for path in MODEL_FILES if path.stem != "remus100"]
"""Models for which `cube-sim new` finds a mission: REMUS 100 has 9 N of lift, which its fins hold on no course."""
FLEET_FILES = [path for path in sorted(SCENARIOS.glob("*.yaml")) if "\nvehicles:\n" in path.read_text()]
"""Scenarios of several vehicles."""
SCENARIO_FILES = [path for path in sorted(SCENARIOS.glob("*.yaml")) if path not in FLEET_FILES]

CUBE = MODELS / "cube.xml"
HELIX = SCENARIOS / "cube_helix.yaml"
