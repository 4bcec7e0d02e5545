# numba turns functions into objects its own annotations cannot describe.
from typing import Any

def __getattr__(name: str) -> Any: ...
