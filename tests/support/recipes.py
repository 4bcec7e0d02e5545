"""The recipes of docs/extending.md: what each edits, and the commands that try it.

A recipe is a section. A numbered line names a file, and the fenced block after it is the file's content or, marked
`diff`, an edit: lines with a blank or `-` in front are looked for as they stand, once in the whole file; `@@` parts one
such place from the next. Blocks marked `sh` are commands.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

_STEP = re.compile(r"^\d+\. `([^`]+)`")


@dataclass(frozen=True)
class Step:
    """A file to write or edit.

    Attributes:
        file: relative to the repository.
        line: where the recipe says so.
        edit: whether `text` is an edit; else it is the whole file.
        text: the block.
    """

    file: str
    line: int
    edit: bool
    text: str

    def apply(self, root: Path) -> None:
        """Do it, in a copy of the repository."""
        target, where = root / self.file, f"docs/extending.md:{self.line}: {self.file}"
        if not self.edit:
            assert not target.exists(), f"{where} is there already"
            target.write_text(self.text, encoding="utf-8")
            return
        assert target.is_file(), f"{where} is not there"
        text = target.read_text(encoding="utf-8")
        for hunk in re.split(r"^@@.*\n", self.text, flags=re.M):
            lines = hunk.splitlines()
            before, after = ("".join(f"{x[1:]}\n" for x in lines if x[:1] != sign) for sign in "+-")
            assert before, f"{where}: nothing says where these lines go:\n{hunk}"
            found = len(re.findall(f"^{re.escape(before)}", text, flags=re.M))
            assert found == 1, f"{where} holds these lines {found} times, not once:\n{before}"
            text = re.sub(f"^{re.escape(before)}", lambda _, new=after: new, text, count=1, flags=re.M)
        target.write_text(text, encoding="utf-8")


@dataclass
class Recipe:
    """A section.

    Attributes:
        title: its heading.
        steps: what it does to files, in order.
        commands: shell lines that try it, in order.
    """

    title: str
    steps: list[Step] = field(default_factory=list)
    commands: list[str] = field(default_factory=list)


def recipes(document: Path) -> list[Recipe]:
    """The sections that have commands."""
    found, file, lines = [Recipe("")], None, iter(enumerate(document.read_text(encoding="utf-8").splitlines(), 1))
    for number, line in lines:
        if line.startswith("## "):
            found.append(Recipe(line[3:]))
            file = None
        elif match := _STEP.match(line):
            assert file is None, f"{document.name}:{number}: no block says what becomes of {file}"
            file = match[1]
        elif line.startswith("```"):
            block = "".join(f"{text}\n" for text in _until_fence(lines))
            if line == "```sh":
                found[-1].commands += block.splitlines()
            elif file is not None:
                found[-1].steps.append(Step(file, number, line == "```diff", block))
                file = None
    return [recipe for recipe in found if recipe.commands]


def _until_fence(lines):
    for _, line in lines:
        if line == "```":
            return
        yield line
