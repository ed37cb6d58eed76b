from pathlib import Path

import pandas as pd
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motion.files import cell_as_given, harmless_cell, harmless_frame, replacing, write_text


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "new" / "folder" / "a.txt"
    write_text(target, "old")
    with pytest.raises(RuntimeError), replacing(target) as temporary:
        assert (temporary.suffix, temporary.parent) == (".txt", target.parent)
        temporary.write_text("half")
        raise RuntimeError
    assert target.read_text() == "old"
    assert list(target.parent.iterdir()) == [target]


def test_a_written_file_has_ordinary_permissions(tmp_path: Path) -> None:
    plain = tmp_path / "plain"
    plain.touch()
    write_text(tmp_path / "a.txt", "x")
    assert (tmp_path / "a.txt").stat().st_mode == plain.stat().st_mode


@pytest.mark.parametrize(
    "formula", ["=A1", "+1+cmd|' /C calc'!A0", "-2+3", "@S(A1)", "\t=1", " =1"]
)
def test_a_formula_becomes_text(formula: str) -> None:
    assert harmless_cell(formula) == "'" + formula


@pytest.mark.parametrize("text", ["", "-2", "+0.5", "-1e-3", "a=b", "rule_based-mismatched", "–"])
def test_numbers_and_other_text_stay(text: str) -> None:
    assert harmless_cell(text) == text


@example("'tis so")
@given(st.text())
def test_no_text_is_lost(text: str) -> None:
    assert cell_as_given(harmless_cell(text)) == text


def test_a_table_keeps_its_numbers_and_gaps() -> None:
    frame = pd.DataFrame({"=a": ["=1", None, "x"], "b": [-1.0, 2.0, float("nan")]})

    result = harmless_frame(frame)

    assert list(result.columns) == ["'=a", "b"]
    assert result["'=a"].tolist()[::2] == ["'=1", "x"]
    assert result["'=a"].isna().tolist() == [False, True, False]
    assert result["b"].equals(frame["b"])
