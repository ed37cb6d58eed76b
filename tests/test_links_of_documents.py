import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\((?P<target>[^)\s]+)\)")
CODE = re.compile(r"^```.*?^```$|`[^`\n]*`", re.MULTILINE | re.DOTALL)
MODULE = re.compile(
    r"(?<![\w/.-])(?:analysis|benchmarks|generators|motion|renderer|studyapp|tests|tools|training)"
    r"/[\w/]+\.py\b"
)
OUTSIDE = ("http://", "https://", "mailto:")


@cache
def prose(document: Path) -> str:
    """Return a document without code."""
    return CODE.sub("", document.read_text(encoding="utf-8"))


@cache
def anchors(document: Path) -> frozenset[str]:
    """Return the anchors that GitHub makes of headings."""
    text = re.sub(r"^```.*?^```$", "", document.read_text(encoding="utf-8"), flags=re.M | re.S)
    headings = re.findall(r"^#{1,6} (.+)$", text, re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return frozenset(heading.strip().replace(" ", "-") for heading in plain)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_link_of_a_document_leads_somewhere(document: Path) -> None:
    for found in LINK.finditer(prose(document)):
        target = found["target"]
        if target.startswith(OUTSIDE):
            continue
        name, _, anchor = target.partition("#")
        there = (document.parent / name).resolve() if name else document
        assert there.exists(), f"{found[0]} leads nowhere"
        assert there.is_relative_to(ROOT), f"{found[0]} leads out of the project"
        if anchor:
            assert anchor in anchors(there), f"{found[0]}: no such heading"


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_module_that_a_document_names_exists(document: Path) -> None:
    named = MODULE.findall(document.read_text(encoding="utf-8"))

    assert [path for path in named if not (ROOT / path).exists()] == []


def test_no_document_is_orphaned() -> None:
    linked = {
        (document.parent / found["target"].partition("#")[0]).resolve()
        for document in DOCUMENTS
        for found in LINK.finditer(prose(document))
        if not found["target"].startswith(OUTSIDE)
    }
    decisions = ROOT / "docs" / "decisions"

    lost = [
        path.relative_to(ROOT).as_posix()
        for path in DOCUMENTS
        if path.is_relative_to(ROOT / "docs")
        and path not in linked
        and not path.is_relative_to(decisions)
    ]

    assert lost == []
