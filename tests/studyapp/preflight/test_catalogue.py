"""Everything that is found is declared, and told in the documents."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from string import Formatter

from renderer.video.loudness import TARGET
from studyapp import preflight
from studyapp.preflight.finding import catalogue, kinds
from studyapp.stimuli.media_probe import DURATION_TOLERANCE
from tools.check_page import DOCS, schema, with_table

MODULES = [path.read_text() for path in Path(preflight.__path__[0]).glob("*.py")]
SOURCE = "\n".join(MODULES)


def test_the_table_in_the_documents_is_the_catalogue() -> None:
    page = (DOCS / "check.md").read_text(encoding="utf-8")

    assert with_table(page) == page, "run python -m tools.check_page"
    assert (DOCS / "check.schema.json").read_text(encoding="utf-8") == schema()


def test_names_are_unique_and_look_alike() -> None:
    names = [name for own in catalogue().values() for name in own]

    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", name) for name in names)


def test_whatever_must_be_decided_has_a_remedy() -> None:
    every = kinds().items()
    assert not [name for name, kind in every if kind.severity != "note" and not kind.remedy]
    assert not [n for n, kind in every if kind.means.endswith(".") or kind.remedy.endswith(".")]


def test_every_kind_is_looked_for_and_nothing_else_is_found() -> None:
    assert [name for name in kinds() if f'"{name}"' not in SOURCE] == []
    assert set(re.findall(r'\bfinding\(\s*"([^"]+)"', SOURCE)) <= set(kinds())


def calls() -> Iterator[tuple[str, set[str]]]:
    """Yield the name and the keywords of each finding that is made where no clause is given."""
    for node in chain.from_iterable(ast.walk(ast.parse(text)) for text in MODULES):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "finding":
            name, *rest = node.args
            if isinstance(name, ast.Constant) and not rest:
                yield str(name.value), {str(each.arg) for each in node.keywords}


def test_every_clause_is_given_its_values() -> None:
    for name, given in calls():
        fields = {field for _, field, _, _ in Formatter().parse(kinds()[name].says) if field}
        assert {field.partition(".")[0] for field in fields} <= given, name


def test_remedies_state_the_numbers_that_are_checked() -> None:
    assert f"by {DURATION_TOLERANCE} s" in kinds()["video-length"].remedy
    for name in ("loudness-differs", "loudness-differs-beside"):
        assert f"{TARGET:g} LUFS" in kinds()[name].remedy
