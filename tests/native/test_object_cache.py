"""Machine code on disk: found again, never stale, never half-written, not needed."""

from __future__ import annotations

import ctypes
import os

import llvmlite.binding as llvm
import numba
import pytest
from numba import types

from cube_sim.native import object_cache


class Builder:
    """Compiles y = factor x + 1 and counts how often it was asked to."""

    def __init__(self, factor: float) -> None:
        self.factor, self.calls = factor, 0

    def __call__(self):
        self.calls += 1
        factor = self.factor
        return {"line": numba.cfunc(types.double(types.double))(lambda x: factor * x + 1.0)}


def line(address: int, x: float) -> float:
    return ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(address)(x)


def test_second_start_needs_no_compiler(tmp_path, monkeypatch):
    monkeypatch.setenv("CUBE_SIM_CACHE_DIR", str(tmp_path))
    first, second, other = Builder(3.0), Builder(3.0), Builder(5.0)
    assert line(object_cache.addresses("three", first, ("line",))["line"], 2.0) == 7.0
    assert line(object_cache.addresses("three", second, ("line",))["line"], 2.0) == 7.0
    assert line(object_cache.addresses("five", other, ("line",))["line"], 2.0) == 11.0
    assert (first.calls, second.calls, other.calls) == (1, 0, 1)


@pytest.mark.parametrize("damage", [lambda c: c[:-7], lambda c: b"", lambda c: c[:60] + bytes([c[60] ^ 1]) + c[61:]])
def test_a_damaged_file_is_compiled_again(tmp_path, monkeypatch, damage):
    monkeypatch.setenv("CUBE_SIM_CACHE_DIR", str(tmp_path))
    object_cache.addresses("key", Builder(3.0), ("line",))
    (file,) = tmp_path.glob("*.o")
    file.write_bytes(damage(file.read_bytes()))
    again = Builder(3.0)
    assert line(object_cache.addresses("key", again, ("line",))["line"], 1.0) == 4.0
    assert again.calls == 1
    assert object_cache.addresses("key", Builder(3.0), ("line",))


def test_nowhere_to_write_is_no_obstacle(tmp_path, monkeypatch):
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    monkeypatch.setenv("CUBE_SIM_CACHE_DIR", str(occupied / "below"))
    monkeypatch.setattr(object_cache.tempfile, "gettempdir", lambda: str(occupied))
    assert line(object_cache.addresses("key", Builder(3.0), ("line",))["line"], 1.0) == 4.0


def test_a_read_only_installation_uses_the_users_cache(tmp_path, monkeypatch):
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    monkeypatch.delenv("CUBE_SIM_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(object_cache.tempfile, "gettempdir", lambda: str(occupied))
    monkeypatch.setattr(object_cache, "__file__", str(occupied / "object_cache.py"))
    object_cache.addresses("key", Builder(3.0), ("line",))
    assert list((tmp_path / "cache" / "cube_sim").glob("line-*.o"))


def test_code_that_leans_on_python_is_not_kept():
    """A division that raises needs the interpreter's exceptions; such code works, but only inside its own process."""
    raising = numba.cfunc(types.double(types.double))(lambda x: 1.0 / x)
    object_cache.addresses("unused", Builder(1.0), ("line",))
    assert object_cache.emit(raising.inspect_llvm(), raising.native_name, "line") is None


def test_code_with_a_symbol_nobody_has_is_not_kept():
    llvm.initialize_native_target()
    text = "declare void @nobody_has_this()\ndefine void @f() {\n call void @nobody_has_this()\n ret void\n}"
    assert object_cache.emit(text, "f", "f") is None


@pytest.fixture
def installation(tmp_path, monkeypatch):
    """One that can be written to or not, of a user with a home or without; what numba is told then."""

    def numba_is_told(*, writable: bool, home: str | None, **environment: str) -> str:
        for name in ("CUBE_SIM_CACHE_DIR", "NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
            monkeypatch.delenv(name, raising=False)
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        # Root may write everywhere; nobody may write below a file.
        occupied = tmp_path / "file"
        occupied.write_text("not a folder")
        package = tmp_path if writable else occupied
        monkeypatch.setattr(object_cache, "__file__", str(package / "native" / "object_cache.py"))
        monkeypatch.setattr(object_cache, "_writable", lambda folder: occupied not in (folder, *folder.parents))
        monkeypatch.setattr(os.path, "expanduser", lambda path: path if home is None else path.replace("~", home))
        monkeypatch.setattr(object_cache.tempfile, "gettempdir", lambda: str(tmp_path))
        return object_cache.numba_folder()

    return numba_is_told


def test_one_variable_says_where_everything_compiled_is_kept(installation, tmp_path):
    named = str(tmp_path / "named")
    assert installation(writable=False, home=None, CUBE_SIM_CACHE_DIR=named) == f"{named}/numba"
    assert installation(writable=True, home=str(tmp_path), CUBE_SIM_CACHE_DIR=named) == f"{named}/numba"
    assert installation(writable=False, home=None, CUBE_SIM_CACHE_DIR=named, NUMBA_CACHE_DIR="/else") == ""


def test_numba_chooses_where_it_can(installation, tmp_path):
    assert installation(writable=True, home=None) == ""
    assert installation(writable=False, home=str(tmp_path)) == ""
    assert installation(writable=False, home=None, XDG_CACHE_HOME=str(tmp_path)) == ""


@pytest.mark.parametrize("home", [None, "occupied"])
def test_without_a_home_a_scratch_folder_of_ones_own_is_taken(installation, tmp_path, home):
    home = None if home is None else str(tmp_path / "file" / "below")
    scratch = tmp_path / f"cube_sim-{os.getuid()}"
    assert installation(writable=False, home=home) == str(scratch / "numba")
    assert scratch.stat().st_mode & 0o777 == 0o700
    # Somebody else could have put code there.
    scratch.chmod(0o777)
    assert installation(writable=False, home=home) == ""


def test_a_user_without_a_home_has_folders_for_object_files(installation, tmp_path):
    installation(writable=False, home=None)
    assert all(folder.is_absolute() for folder in object_cache.cache_folders())


def test_a_named_folder_that_cannot_be_written_is_read_and_scratch_takes_the_rest(installation, tmp_path):
    named, scratch = tmp_path / "file" / "named", tmp_path / f"cube_sim-{os.getuid()}"
    assert installation(writable=False, home=None, CUBE_SIM_CACHE_DIR=str(named)) == str(scratch / "numba")
    assert object_cache.cache_folders() == [named, scratch]
