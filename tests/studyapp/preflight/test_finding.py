"""Everything that is found is declared, and told in the documents."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from string import Formatter

from renderer.loudness import TARGET
from studyapp import preflight
from studyapp.preflight.finding import Finding, catalogue, kinds, record, summed_up, told
from studyapp.stimuli import media_probe
from tools.check_page import DOCS, schema, with_table

MODULES = [path.read_text() for path in Path(preflight.__path__[0]).glob("*.py")]
SOURCE = "\n".join([*MODULES, Path(media_probe.__file__).read_text()])


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
    assert f"by {media_probe.DURATION_TOLERANCE} s" in kinds()["video-length"].remedy
    for name in ("loudness-differs", "loudness-differs-beside"):
        assert f"{TARGET:g} LUFS" in kinds()[name].remedy


def gone(what: str, *, where: str = "", remedy: str = "Bring it") -> Finding:
    return Finding(name="gone", severity="error", what=what, where=where, remedy=remedy)


def odd(what: str, *, where: str) -> Finding:
    return Finding(name="odd", severity="warning", what=what, where=where, remedy="Look at it")


def known(what: str, *, where: str = "") -> Finding:
    return Finding(name="known", severity="note", what=what, where=where, remedy="")


def lines(findings: list[Finding], *, everything: bool = False) -> str:
    return "\n".join(told(findings, everything=everything))


def test_a_finding_is_told_with_name_place_and_remedy() -> None:
    said = lines([gone("the video is gone", where="videos/a.mp4")])

    assert said.strip() == "error: gone\n  videos/a.mp4: the video is gone.\n  > Bring it."


def test_a_place_that_the_sentence_names_is_not_told_twice() -> None:
    assert lines([gone("a.mp4 is gone", where="a.mp4")]).count("a.mp4") == 1


def test_findings_of_one_kind_are_told_together_and_many_are_counted() -> None:
    many = [gone(f"video {number} is gone") for number in range(9)]

    said = lines([many[0], known("it is known"), *many[1:]])

    assert said.count("error: gone") == 1
    assert said.count("is gone.") == 3
    assert "and 6 more like these" in said
    assert said.count("> Bring it.") == 1
    assert lines(many, everything=True).count("is gone.") == 9


def test_a_record_counts_and_keeps_everything() -> None:
    made = record("mine", [gone("a"), odd("b", where="w"), known("c")])

    assert (made.errors, made.warnings, made.notes) == (1, 1, 1)
    assert [found.name for found in made.findings] == ["gone", "odd", "known"]
    assert made.findings[1].model_dump() == {
        "name": "odd", "severity": "warning", "where": "w", "what": "b", "remedy": "Look at it",
    }  # fmt: skip
    assert summed_up(made) == "1 error, 1 warning"
    assert summed_up(record("mine", [])) == "0 errors, 0 warnings"
