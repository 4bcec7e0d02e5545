"""A function or class of the user's own: found, its source kept, its failures said in one line."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import partial, reduce
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from cube_sim.errors import OwnCodeError, ScenarioError
from cube_sim.mission.own.neighbours import importable, neighbours_of
from cube_sim.mission.own.packages import Modules, import_from, modules_of, recorded_modules
from cube_sim.scenario import Loaded
from cube_sim.scenario.file_names import code_place
from cube_sim.scenario.python_block import PythonBlock, python_blocks
from cube_sim.spatial import LARGEST, Vector, real_numbers

PREFIX = "cube_sim_own_"
"""Of the modules that files become."""


@dataclass(frozen=True)
class OwnCode:
    """A factory of the user's own, and where it comes from.

    Attributes:
        key: dotted path of the scenario's value in whose place it stands.
        name: what it is called where files go by their names: file.py:name or package.module:name.
        file: its file, as its frames name it; "" for none.
        source: text of that file; "" where there is none.
        make: the factory; of a path that a program hands over, the path.
        options: its keyword arguments.
        neighbours: contents of the files beside its file that this imports, by name.
        modules: contents of its module's file and of those that this imports, by name; none where it goes by its file.
        not_taken: why these are not all that it imports; "" where they are.
        given: whether a program hands it over.
    """

    key: str
    name: str
    file: str
    source: str
    make: Any
    options: Mapping[str, Any]
    neighbours: Mapping[str, bytes] = field(default_factory=dict)
    modules: Mapping[str, bytes] = field(default_factory=dict)
    not_taken: str = ""
    given: bool = False

    @property
    def digest(self) -> str:
        """SHA-256 of the source, hexadecimal."""
        return sha256(self.source.encode()).hexdigest()

    def call(self, function: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        """What a function of this code answers.

        Raises:
            OwnCodeError: it raises; the text says what, and where.
        """
        try:
            return function(*arguments, **options)
        except OwnCodeError:
            raise
        except (Exception, SystemExit) as error:
            raise OwnCodeError(self.key, self.said(error)) from error

    def refuse(self, message: str) -> OwnCodeError:
        """The error that what this code answers is no answer."""
        return OwnCodeError(self.key, f"{self.name} {message}")

    def said(self, error: BaseException) -> str:
        """An error in one line, with the line of this code that raised it or called what did."""
        return failure(error, self.file) or f"{self.name}: {one_line(error)}"


Codes = Mapping[str, OwnCode]
"""Dotted path of a scenario's value -> the code in its place."""
NO_CODES: Codes = MappingProxyType({})


def codes_of(loaded: Loaded) -> Codes:
    """All code that a scenario names, or that a program hands over with it.

    Raises:
        ScenarioError: some of it cannot be found; with positions.
    """
    found, mistakes = {}, []
    blocks = list(python_blocks(loaded.scenario))
    roots = [recorded_modules(loaded.path.parent, code_place(block.python)[0]) for _, block in blocks]
    import_from(next((root for root in roots if root is not None), None))
    for key, block in blocks:
        try:
            found[key] = own_code(loaded, key, block)
        except ScenarioError as error:
            mistakes += error.mistakes
    if mistakes:
        raise ScenarioError(mistakes)
    return found


def own_code(loaded: Loaded, key: str, block: PythonBlock) -> OwnCode:
    """The code of one block.

    Raises:
        ScenarioError: it cannot be found; with position.
    """
    place, name = code_place(block.python)
    given = loaded.given.get(key)
    where = f"{key}.python"

    def mistake(text: str) -> ScenarioError:
        return ScenarioError([loaded.mistake(where, text)])

    shown = Path(place).name if place.endswith(".py") else place
    if given is not None:
        file = source_file(given)
        # The keywords of a partial function are in it: the scenario has them for whoever flies it again.
        within = given.keywords if isinstance(given, partial) else {}
        options = {name: value for name, value in block.options.items() if name not in within}
        of_file = f"{shown}:{name}", file, _text(file), given, options, _beside(file)
        return OwnCode(key, *of_file, *_modules(place), given=True)
    try:
        module = _module_of_file(Path(place)) if place.endswith(".py") else importlib.import_module(place)
    except ModuleNotFoundError as error:
        if error.name is not None and f"{place}.".startswith(f"{error.name}."):
            raise mistake(f"no module '{error.name}' on Python's path") from None
        raise mistake(failure(error, place) or f"{shown}: {one_line(error)}") from None
    except (Exception, SystemExit) as error:
        raise mistake(failure(error, place) or f"{shown}: {one_line(error)}") from None
    try:
        found = reduce(getattr, name.split("."), module)
    except AttributeError:
        raise mistake(f"{shown} has no {name}{_suggestion(name, module)}") from None
    file = getattr(module, "__file__", None) or ""
    beside = _beside(file if place.endswith(".py") else "")
    return OwnCode(key, f"{shown}:{name}", file, _text(file), found, block.options, beside, *_modules(place))


def made(loaded: Loaded, code: OwnCode, *arguments: Any) -> Any:
    """What the factory makes of what it is given and of its options.

    Raises:
        ScenarioError: it is nothing that can be called, does not take them, or raises; with position.
    """
    require_taken(loaded, code, len(arguments))
    with refused(loaded):
        return code.call(code.make, *arguments, **code.options)


def require_taken(loaded: Loaded, code: OwnCode, count: int) -> None:
    """Refuse a factory that does not take so many arguments and its options."""
    if not callable(code.make):
        raise ScenarioError([loaded.mistake(f"{code.key}.python", f"{code.name} is no function or class")])
    try:
        inspect.signature(code.make).bind(*[None] * count, **code.options)
    except ValueError:
        pass  # no signature to look at
    except TypeError as error:
        where = f"{code.key}.{'options' if code.options else 'python'}"
        raise ScenarioError([loaded.mistake(where, f"{code.name}: {error}")]) from None


def without(thing: Any, methods: Sequence[str]) -> str:
    """The methods an object lacks, in words; "" for none."""
    return " and ".join(name for name in methods if not callable(getattr(thing, name, None)))


def numbers_of(code: OwnCode, answer: Any, shape: tuple[int, ...], what: str) -> Vector:
    """Finite numbers of a shape.

    Raises:
        OwnCodeError: the answer is something else.
    """
    wanted = (
        f"{' x '.join(map(str, shape))} numbers" if shape not in ((), (1,)) else "a number" if not shape else "1 number"
    )
    numbers = real_numbers(answer)
    if numbers is None:
        raise code.refuse(f"answers {what} {answer!r:.60}; it takes {wanted}")
    if numbers.shape != shape:
        got = ": nothing" if answer is None else f" of shape {numbers.shape}"
        raise code.refuse(f"answers {what}{got}; it takes {wanted}")
    if not np.isfinite(numbers).all():
        raise code.refuse(f"answers {what} {numbers.tolist()}; every number must be finite")
    if np.abs(numbers).max(initial=0.0) > LARGEST:
        raise code.refuse(f"answers {what} {numbers.tolist()}; no number may be larger than {LARGEST:g}")
    return numbers


@contextmanager
def refused(loaded: Loaded) -> Iterator[None]:
    """What own code does wrong in here is a mistake of the scenario."""
    try:
        yield
    except OwnCodeError as error:
        raise ScenarioError([loaded.mistake(f"{error.key}.python", error.reason)]) from error


def one_line(error: BaseException) -> str:
    """An error's kind and text."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def failure(error: BaseException, file: str) -> str:
    """An error and the line of a file that raised it, or called what did; "" where the file has no part in it."""
    if isinstance(error, SyntaxError) and error.filename == file:
        return f"{Path(file).name}:{error.lineno}: {type(error).__name__}: {error.msg}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return f"{Path(file).name}:{lines[-1]}: {one_line(error)}" if file and lines else ""


def source_file(thing: Any) -> str:
    """The file in which a function, a class or the class of an object is defined; "" where there is none.

    Of a partial one it is that of the whole.
    """
    while isinstance(thing, partial):
        thing = thing.func
    try:
        file = inspect.getsourcefile(thing if inspect.isroutine(thing) or inspect.isclass(thing) else type(thing))
    except TypeError:
        return ""
    return file if file is not None and Path(file).is_file() else ""


def _module_of_file(file: Path) -> ModuleType:
    """A file run as a module, once for each text it has had, and the files beside it that it imports."""
    content = file.read_bytes()
    texts = [str(file).encode(), content, *_beside(str(file)).values()]
    name = PREFIX + sha256(b"\0".join(texts)).hexdigest()[:16]
    with _running:
        if name in sys.modules:
            return sys.modules[name]
        module = ModuleType(name)
        module.__file__ = str(file)
        # What is defined in it looks for its module there: dataclasses, pickles.
        sys.modules[name] = module
        try:
            with importable(file):
                exec(compile(importlib.util.decode_source(content), str(file), "exec"), module.__dict__)
        except BaseException:
            del sys.modules[name]
            raise
        return module


_running = threading.RLock()
"""Held while a file is run: another thread must not take for whole a module that is there by name alone."""


def _beside(file: str) -> dict[str, bytes]:
    if not file.endswith(".py"):
        return {}
    return {name: place.read_bytes() for name, place in neighbours_of(Path(file)).items()}


def _modules(place: str) -> Modules:
    return Modules({}, "") if place.endswith(".py") else modules_of(place)


def _text(file: str) -> str:
    is_text = file.endswith(".py") and Path(file).is_file()
    return importlib.util.decode_source(Path(file).read_bytes()) if is_text else ""


def _suggestion(name: str, module: ModuleType) -> str:
    own = [key for key, value in vars(module).items() if getattr(value, "__module__", None) == module.__name__]
    near = get_close_matches(name, own, n=1)
    if near:
        return f"; did you mean {near[0]}?"
    return f"; it has {', '.join(own)}" if own else ""
