# MuJoCo's compiled modules ship without type information.
from typing import Any

def __getattr__(name: str) -> Any: ...
