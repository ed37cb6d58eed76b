import re

import pytest

from tools.handbook.command_pages import HEADINGS, INDEX, PAGES, by_hand, commands, pages

WRITTEN = {path.stem: path.read_text(encoding="utf-8") for path in sorted(PAGES.glob("*.md"))}
COMMANDS = [name for name in commands() if " " not in name]
LEAST_WORDS = 8
"""Fewer under a heading say nothing."""


def test_every_command_has_a_page_and_a_place_in_the_index() -> None:
    placed = set(re.findall(r"`([a-z-]+)`", by_hand(WRITTEN[INDEX])))

    assert sorted(WRITTEN) == sorted([*COMMANDS, INDEX])
    assert placed - {"motionjury"} == set(COMMANDS)


@pytest.mark.parametrize("name", [*COMMANDS, INDEX])
def test_a_page_says_what_the_code_says(name: str) -> None:
    assert WRITTEN[name] == pages(WRITTEN)[name], "run 'make pages'"


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("heading", HEADINGS)
def test_every_page_has_a_handwritten_introduction(name: str, heading: str) -> None:
    hand = by_hand(WRITTEN[name])

    below = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", hand, re.MULTILINE | re.DOTALL)

    assert below is not None
    assert len(below[1].split()) >= LEAST_WORDS
