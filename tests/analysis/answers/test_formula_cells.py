from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.answers.cells import read_cells
from analysis.report.writing import write_frame

FORMULA = '=HYPERLINK("http://example.org","x")'


def test_a_table_of_the_report_runs_nothing_in_a_spreadsheet(tmp_path: Path) -> None:
    write_frame(tmp_path / "t.csv", pd.DataFrame({"who": [FORMULA, "ada"], "share": [-0.5, 1.0]}))

    written = pd.read_csv(tmp_path / "t.csv")

    assert written["who"].tolist() == ["'" + FORMULA, "ada"]
    assert written["share"].tolist() == [-0.5, 1.0]


@pytest.mark.parametrize("name", [FORMULA, "'tis", "''", "-x", "plain"])
def test_what_was_written_is_read_as_it_was(tmp_path: Path, name: str) -> None:
    write_frame(tmp_path / "t.csv", pd.DataFrame({"participant": [name, "ada"]}))

    cells = read_cells(tmp_path / "t.csv", ["participant"], ["participant"])

    assert cells.rows["participant"].tolist() == [name, "ada"]
