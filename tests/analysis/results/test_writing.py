from __future__ import annotations

import csv
import json
from pathlib import Path

import pandas as pd
import pytest

from analysis.results.report import analyse_table
from analysis.results.writing import write_table_report
from motion.errors import InputError
from tests.analysis.results.made_tables import TABLES

COMMON = [
    *("protocol", "source", "settings", "participants", "rules", "exclusions"),
    *("conditions_shown", "questions", "sets", "notes", "remark", "quality"),
]
KEYS = {
    "pairwise": [
        *("comparisons", "side_bias", "agreement", "test_retest", "bradley_terry", "equivalence")
    ],
    "rating": ["conditions", "clmm", "contrasts", "agreement", "test_retest", "equivalence"],
    "ranking": ["conditions", "plackett_luce", "kendall_w", "friedman"],
    "mismatch": ["conditions", "side_bias", "agreement", "test_retest"],
}


@pytest.mark.parametrize("protocol", TABLES)
def test_two_runs_write_the_same_bytes(protocol: str, tmp_path: Path) -> None:
    path = tmp_path / "answers.csv"
    TABLES[protocol](participants=5, segments=4).assign(emotion="joy").to_csv(path, index=False)
    runs = []
    for name in ("one", "two"):
        page = write_table_report(analyse_table(path, protocol), tmp_path / name)
        files = sorted(page.parent.rglob("*"))
        runs.append({file.name: file.read_bytes() for file in files if file.is_file()})

    assert runs[0] == runs[1]
    results = json.loads(runs[0]["results.json"])
    assert list(results) == COMMON + KEYS[protocol]
    assert results["source"]["file"] == "answers.csv"
    assert str(tmp_path) not in runs[0]["results.json"].decode()
    tables = [name for name in runs[0] if name.endswith(".csv")]
    assert tables
    for name in tables:
        rows = list(csv.reader(runs[0][name].decode().splitlines()))
        assert len({len(row) for row in rows}) == 1


def test_the_page_escapes_names_and_says_what_was_found(tmp_path: Path) -> None:
    path = tmp_path / "answers.csv"
    table = TABLES["pairwise"](("<b>ours", "other"), effects=(2.0, 0.0), seed=3)  # type: ignore[call-arg]
    table.to_csv(path, index=False)
    page = write_table_report(analyse_table(path, "pairwise"), tmp_path).read_text("utf-8")
    assert "&lt;b&gt;ours over other (emotion)" in page
    assert "<b>ours" not in page
    assert "No rule of exclusion applies" in page


@pytest.mark.parametrize(("protocol", "margin"), [("ranking", 0.1), ("pairwise", 0.0)])
def test_a_margin_that_means_nothing_is_refused(
    protocol: str, margin: float, tmp_path: Path
) -> None:
    path = tmp_path / "answers.csv"
    pd.DataFrame().to_csv(path)
    with pytest.raises(InputError):
        analyse_table(path, protocol, margin=margin)
