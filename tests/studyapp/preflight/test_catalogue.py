"""The table of all findings is the code's: nothing is found that it does not tell."""

from __future__ import annotations

import importlib
import pkgutil
import re
from pathlib import Path

import pytest

from studyapp import preflight
from studyapp.preflight.catalogue import ROOMS, kinds, schema, table, with_table
from studyapp.preflight.finding import FindingKind, Severity

DOCS = Path(__file__).resolve().parents[3] / "docs"
KINDS = [kind for own in kinds().values() for kind in own]


def test_the_table_in_the_documents_is_the_codes() -> None:
    page = (DOCS / "check.md").read_text(encoding="utf-8")

    assert with_table(page) == page, "run python -m studyapp.preflight.catalogue --write docs"
    assert (DOCS / "check.schema.json").read_text(encoding="utf-8") == schema()


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="no place between"):
        with_table("# A page")


def test_every_module_that_finds_something_has_a_room() -> None:
    modules = [
        importlib.import_module(f"{preflight.__name__}.{found.name}")
        for found in pkgutil.iter_modules(preflight.__path__)
    ]
    declaring = {
        kind.name
        for module in modules
        for kind in vars(module).values()
        if isinstance(kind, FindingKind)
    }

    assert declaring == {kind.name for kind in KINDS}
    assert {module for own in ROOMS.values() for module in own} <= set(modules)


def test_names_are_unique_and_look_alike() -> None:
    names = [kind.name for kind in KINDS]

    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", name) for name in names)
    assert "\n".join(table()).count("| `") == len(names)


def test_whatever_must_be_decided_has_a_remedy() -> None:
    assert not [k.name for k in KINDS if k.severity is not Severity.NOTE and not k.remedy]
    assert not [k.name for k in KINDS if k.means.endswith(".") or k.remedy.endswith(".")]


def test_every_kind_is_looked_for_somewhere() -> None:
    source = "\n".join(path.read_text() for path in Path(preflight.__path__[0]).glob("*.py"))
    declared = dict(
        re.findall(r'^([A-Z_]+): Final = (?:error|warning|note)\(\s*"([a-z-]+)"', source, re.M)
    )

    assert set(declared.values()) == {kind.name for kind in KINDS}
    unused = [name for name in declared if len(re.findall(rf"\b{name}\b", source)) < 2]
    assert unused == []
