from pathlib import Path

from tools.worked_examples.amuse_study import TABLE_A5
from tools.worked_examples.page import worked_examples

PAGE = Path(__file__).resolve().parents[3] / "docs" / "worked-examples.md"
PAPER = "papers/amuse.txt"


def test_the_docs_page_has_the_computed_numbers() -> None:
    assert PAGE.read_text("utf-8") == worked_examples(), "run 'make worked-examples'"


def test_the_table_matches_the_paper(shared_data: Path) -> None:
    text = (shared_data.parent / PAPER).read_text("utf-8")
    lines = text[text.index("Table A.5.") :].splitlines()[:10]
    for printed in {row.other for row in TABLE_A5}:
        (cells,) = (line.split("\t")[1:] for line in lines if line.startswith(f"{printed}\t"))
        rows = [row for row in TABLE_A5 if row.other == printed]
        assert list(map(int, cells)) == [n for row in rows for n in (row.ours, row.others)]
