"""What kinds of arguments a compiled function is called with: machine code is made for each combination of them."""

from __future__ import annotations

from typing import Any

import numpy as np

_FLOATS, _INTEGERS, _TRUTHS = (float, np.float64), (int, np.int64), (bool, np.bool_)
_NAMES = {
    **dict.fromkeys(_FLOATS, "float64"),
    **dict.fromkeys(_INTEGERS, "int64"),
    **dict.fromkeys(_TRUTHS, "bool"),
    type(None): "none",
}
_C, _F, _ALIGNED, _WRITEABLE = 1, 2, 0x100, 0x400  # of numpy's flags
_SEEN = _C | _F | _ALIGNED | _WRITEABLE
_LARGEST = 2**63

Kind = tuple[Any, ...]
"""Of a tuple of arguments; equal for those that the same machine code takes, and sometimes for fewer."""


class UnknownKindError(Exception):
    """An argument of which only numba can tell what it is."""


def kinds_of(arguments: tuple[Any, ...]) -> Kind:
    """What machine code has to know of arguments.

    Raises:
        UnknownKindError: numba has to be asked.
    """
    kinds: list[Any] = [type(arguments)]
    for each in arguments:
        cls = type(each)
        if cls is np.ndarray:
            kinds += each.dtype, each.ndim, each.flags.num & _SEEN
        elif cls is np.void:  # one of a structured array
            kinds += each.dtype, "record", _SEEN
        elif cls in _NAMES:
            kinds.append(_NAMES[cls])
            if cls is int and not -_LARGEST <= each < _LARGEST:
                raise UnknownKindError
        elif isinstance(each, tuple):
            kinds.append(kinds_of(each))
        else:
            raise UnknownKindError
    return tuple(kinds)


def text_of(kind: Kind) -> str:
    """The same in words that another process understands, and that are the same for all that numba does not tell apart.

    Raises:
        UnknownKindError: a kind of array that another process may take for another one.
    """
    said, rest = [], list(kind[1:])
    while rest:
        part = rest.pop(0)
        if isinstance(part, np.dtype):
            said.append(_array(part, rest.pop(0), rest.pop(0)))
        else:
            said.append(text_of(part) if isinstance(part, tuple) else part)
    cls = kind[0]
    named = f"{cls.__module__}.{cls.__qualname__}{getattr(cls, '_fields', '')}"
    return f"{named}({', '.join(said)})"


def _array(dtype: np.dtype[Any], dimensions: int, flags: int) -> str:
    if dtype.hasobject:
        raise UnknownKindError
    layout = "C" if flags & _C else "F" if flags & _F else "A"
    special = [word for bit, word in ((_WRITEABLE, "read-only"), (_ALIGNED, "unaligned")) if not flags & bit]
    return " ".join([f"{dimensions}{layout}", *special, repr(dtype)])
