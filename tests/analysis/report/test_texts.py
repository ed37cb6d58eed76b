"""Everything in the templates is used, and unknown names are errors."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from jinja2 import UndefinedError

from analysis.report.texts import paragraphs, table

REPORT = Path("analysis/report")
SOURCES = "\n".join(
    path.read_text("utf-8")
    for path in (
        *REPORT.rglob("*.py"),
        *Path("analysis/planning").glob("*.py"),
        Path("studyapp/rehearsal/recovery_page.py"),
    )
)


@pytest.mark.parametrize("name", ["tables", "figures"])
def test_every_described_table_and_figure_is_made(name: str) -> None:
    described = tomllib.loads((REPORT / "templates" / f"{name}.toml").read_text("utf-8"))
    assert [key for key in described if f'"{key}"' not in SOURCES] == []


@pytest.mark.parametrize("file", sorted((REPORT / "templates/words").glob("*.txt")), ids=str)
def test_every_macro_is_used_by_a_section_or_by_another_macro(file: Path) -> None:
    text = file.read_text("utf-8")
    macros = re.findall(r"{% macro (\w+)\(", text)
    assert [
        macro
        for macro in macros
        if f'"{file.stem}.{macro}"' not in SOURCES and text.count(f"{macro}(") < 2
    ] == []


def test_an_unknown_name_in_a_template_is_an_error() -> None:
    with pytest.raises(UndefinedError):
        paragraphs("plan.assumed", together=[])
    with pytest.raises(UndefinedError):
        table("exclusions", [()])


def test_a_line_break_in_a_name_does_not_end_the_paragraph() -> None:
    said = paragraphs("participants.stills", segment="s1", transcript="one\n\ntwo", missing=[])
    assert len(said) == 1
    assert said[0].endswith("The speech: “one two”")
