"""Findings are declared and documented, and printed for people."""

import ast
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from string import Formatter

import pytest

from studyapp import preflight
from studyapp.preflight.finding import Finding, catalogue, kinds, text_lines
from studyapp.stimuli import media_probe
from tools.handbook.check_page import DOCS, schema, with_table

MODULES = [path.read_text() for path in Path(preflight.__path__[0]).glob("*.py")]
SOURCE = "\n".join([*MODULES, Path(media_probe.__file__).read_text()])


def test_the_documented_table_matches_the_catalogue() -> None:
    page = (DOCS / "check.md").read_text(encoding="utf-8")

    assert with_table(page) == page, "run 'make pages'"
    assert (DOCS / "check.schema.json").read_text(encoding="utf-8") == schema()


def test_names_are_unique_and_errors_and_warnings_have_a_remedy() -> None:
    names = [name for subject in catalogue().values() for name in subject]

    assert len(set(names)) == len(names)
    for name, kind in kinds().items():
        assert kind.severity == "note" or kind.remedy, name
        assert not kind.means.endswith(".") and not kind.remedy.endswith("."), name


def test_every_kind_is_checked_and_no_other() -> None:
    assert [name for name in kinds() if f'"{name}"' not in SOURCE] == []
    assert set(re.findall(r'\b(?:make_finding|finding_of_error)\(\s*"([^"]+)"', SOURCE)) <= set(
        kinds()
    )


def calls() -> Iterator[tuple[str, set[str]]]:
    """Yield the name and the keywords of each finding that is made without a clause."""
    for node in chain.from_iterable(ast.walk(ast.parse(text)) for text in MODULES):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "make_finding":
            name, *clause = node.args
            if isinstance(name, ast.Constant) and not clause:
                yield str(name.value), {str(keyword.arg) for keyword in node.keywords}


def test_every_placeholder_of_a_finding_is_filled() -> None:
    for name, keywords in calls():
        fields = {field for _, field, _, _ in Formatter().parse(kinds()[name].says) if field}
        assert {field.partition(".")[0] for field in fields} <= keywords, name


def missing(what: str, *, where: str = "", remedy: str = "Add it") -> Finding:
    return Finding(name="missing", severity="error", what=what, where=where, remedy=remedy)


NOTE = Finding(name="known", severity="note", what="it is known", where="", remedy="")


def output(*findings: Finding, everything: bool = False) -> str:
    return "\n".join(text_lines(findings, everything=everything))


def test_a_finding_is_printed_with_name_place_and_remedy_and_those_of_a_kind_together() -> None:
    text = output(missing("the video is missing", where="videos/a.mp4"))
    assert text.strip() == "error: missing\n  videos/a.mp4: the video is missing.\n  > Add it."
    assert output(missing("a.mp4 is missing", where="a.mp4")).count("a.mp4") == 1

    many = [missing(f"video {number} is missing") for number in range(9)]
    text = output(many[0], NOTE, *many[1:])
    assert text.count("error: missing") == text.count("> Add it.") == 1
    assert text.count("is missing.") == 3
    assert "and 6 more like these" in text
    assert output(*many, everything=True).count("is missing.") == 9
    assert "it is known." in output(NOTE, everything=True)


def test_findings_fit_a_narrow_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    assert max(map(len, output(missing("many words " * 30)).splitlines())) <= 60
