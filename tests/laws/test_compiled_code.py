"""What compiled functions leave out because of what numba makes of it."""

import ast

import pytest
from support.places import REPO

WAYS = {"compiled", "inlined", "unlocked"}
ARRAYS = [
    "a[:] = b",
    "a[1:4] = b[1:4]",
    "a[i, :2] = f(b)",
    "a[:3], a[3:] = b, c",
    "a[3], b[:] = 1.0, c",
    "a[0].b[:] = c.d",
    "a[:] = b[:] = c",
]
OTHERS = ["a[:] = 0.0", "a[:], b[:] = 0.0, -1.0", "a[0] = b", "a[i, j] = b", "a = b[:3]", "a[:] += 1.0"]


def assigned_slices(tree: ast.AST) -> list[int]:
    """Lines of compiled functions that assign something else than a constant to a slice."""
    found = []
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef):
            continue
        if not WAYS & {way.id for way in function.decorator_list if isinstance(way, ast.Name)}:
            continue
        for node in ast.walk(function):
            for target in node.targets if isinstance(node, ast.Assign) else ():
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple):
                    values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value] * len(target.elts)
                    pairs = list(zip(target.elts, values, strict=True))
                found += [node.lineno for at, value in pairs if _is_slice(at) and not _is_constant(value)]
    return found


def _is_slice(target: ast.expr) -> bool:
    return isinstance(target, ast.Subscript) and any(isinstance(node, ast.Slice) for node in ast.walk(target.slice))


def _is_constant(value: ast.expr) -> bool:
    return not any(isinstance(node, ast.Name | ast.Attribute | ast.Call) for node in ast.walk(value))


def test_no_array_is_assigned_to_a_slice():
    """numba would compile sentences about shapes that do not fit, seconds of them: `cube_sim.tuples.put` says it."""
    found = {}
    for file in (REPO / "cube_sim").rglob("*.py"):
        if lines := assigned_slices(ast.parse(file.read_text(encoding="utf-8"))):
            found[str(file.relative_to(REPO))] = lines
    assert found == {}


@pytest.mark.parametrize("way", sorted(WAYS))
@pytest.mark.parametrize("line", ARRAYS + OTHERS)
def test_such_lines_are_known(way, line):
    told = assigned_slices(ast.parse(f"@{way}\ndef f(a, b):\n    {line}\n"))
    assert set(told) == ({3} if line in ARRAYS else set())
