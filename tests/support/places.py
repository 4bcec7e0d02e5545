"""Where things stand in the repository."""

from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
MODELS = REPO / "models"
SCENARIOS = REPO / "scenarios"

MODEL_FILES = sorted(MODELS.glob("*.xml"))
SCENARIO_FILES = sorted(SCENARIOS.glob("*.yaml"))

CUBE = MODELS / "cube.xml"
HELIX = SCENARIOS / "cube_helix.yaml"
