"""The glossary names what is in the code, and names it once."""

import ast
import re

from support.places import REPO

ROW = re.compile(r"^\|(?P<cells>.*)\|$")
NAME = re.compile(r"`([A-Za-z_]\w*)`")


def identifiers() -> set[str]:
    """Names of modules, classes, functions, arguments, attributes and fields of cube_sim."""
    found: set[str] = set()
    for file in (REPO / "cube_sim").rglob("*.py"):
        found.add(file.stem)
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            match node:
                case ast.ClassDef(name=name) | ast.FunctionDef(name=name) | ast.arg(arg=name):
                    found.add(name)
                case ast.Name(id=name) | ast.Attribute(attr=name):
                    found.add(name)
    return found


def rows() -> list[tuple[str, str]]:
    """(names column, whole row) of every table, headings and rulers left out."""
    told = []
    column = None
    for line in (REPO / "docs" / "glossary.md").read_text(encoding="utf-8").splitlines():
        match = ROW.match(line)
        if match is None:
            column = None
            continue
        cells = [cell.strip() for cell in match["cells"].split(" | ")]
        if "in code" in cells:
            column = cells.index("in code")
        elif column is not None and not set(line) <= set("|- "):
            told.append((cells[column].strip(" |"), line))
    return told


def test_the_tables_are_read():
    assert len(rows()) > 80


def test_every_name_of_the_glossary_exists():
    known = identifiers()
    missing = {name: row for names, row in rows() for name in NAME.findall(names) if name not in known}
    assert missing == {}


def test_a_class_name_stands_for_one_class():
    """Every class of the package has its name for itself, private ones apart."""
    places: dict[str, list[str]] = {}
    for file in (REPO / "cube_sim").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places.setdefault(node.name, []).append(str(file.relative_to(REPO)))
    assert {name: files for name, files in places.items() if len(files) > 1} == {}
