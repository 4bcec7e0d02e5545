"""Every link in the guides leads to something: a file of the repository, and a heading where one is named."""

from __future__ import annotations

import re

import pytest
from support.places import REPO

from cube_sim.commands.pages.markdown import anchor

GUIDES = sorted([*REPO.glob("*.md"), *(REPO / "docs").glob("*.md")])


@pytest.mark.parametrize("guide", GUIDES, ids=lambda path: path.name)
def test_every_link_leads_somewhere(guide):
    text = re.sub(r"^```.*?^```", "", guide.read_text(), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" in target:
            continue
        file, _, heading = target.partition("#")
        leads_to = guide.parent / file if file else guide
        assert leads_to.exists(), target
        if heading:
            titles = re.findall(r"^#+ (.*)$", leads_to.read_text(), re.MULTILINE)
            assert heading in map(anchor, titles), target
