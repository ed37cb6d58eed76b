from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from analysis.answers.cells import read_cells
from analysis.answers.reading import MARKED, read_answers
from analysis.answers.table import MISMATCH, PAIRWISE, RANKING, RATING_OF_ONE, AnswerTable, Layout
from analysis.report.tables import write_frame
from analysis.results.ranking import placements_of
from motion.errors import InputError
from tests.analysis.results.made_tables import read_table

ROW: dict[str, Any] = {
    "participant": "anna",
    "segment": "s1",
    "question": "emotion",
    "left": "ours",
    "right": "other",
    "response": 2,
}

FORMULA = '=HYPERLINK("http://example.org","x")'


def pairs(*changes: dict[str, Any]) -> pd.DataFrame:
    return pd.DataFrame([ROW | change for change in changes])


def read(folder: Path, table: pd.DataFrame) -> AnswerTable:
    return read_table(table, "pairwise", folder)


def refusal(folder: Path, table: pd.DataFrame) -> str:
    with pytest.raises(InputError) as caught:
        read(folder, table)
    return str(caught.value)


def read_text(folder: Path, text: str, layout: Layout = PAIRWISE) -> AnswerTable:
    path = folder / "answers.csv"
    path.write_text(text, "utf-8-sig")
    return read_answers(path, layout)


def test_names_stand_in_the_order_in_which_the_table_names_them(tmp_path: Path) -> None:
    result = read(
        tmp_path,
        pairs(
            {"kind": "catch", "left": "broken", "right": "truth", "correct_side": "right"},
            {"kind": "practice", "left": "zebra", "right": "ours", "question": "b"},
            {"kind": "main", "left": "ours", "right": "apple", "question": "a"},
            {"kind": "main", "left": "apple", "right": "zebra", "question": "b"},
        ),
    )
    assert result.conditions == ("zebra", "ours", "apple")
    assert result.questions == ("b", "a")
    assert result.participants == ("anna",)
    assert not result.has_sets


def test_a_bad_cell_is_named_by_file_row_and_column(tmp_path: Path) -> None:
    text = refusal(tmp_path, pairs({}, {}, {"response": 7}, {"response": 9}))
    assert text == (
        "answers.csv, row 4, column response: '7' is not a whole number from 1 (strongly left) to "
        "5 (strongly right). Correct the cell, or remove the row."
    )


@pytest.mark.parametrize(
    ("change", "column"),
    [
        ({"participant": ""}, "participant"),
        ({"segment": " "}, "segment"),
        ({"left": ""}, "left"),
        ({"response": "2.5"}, "response"),
        ({"response": "often"}, "response"),
        ({"right": "ours"}, "right"),
        ({"kind": "warm-up"}, "kind"),
        ({"response_seconds": -1}, "response_seconds"),
        ({"kind": "catch"}, "correct_side"),
        ({"kind": "catch", "correct_side": "up"}, "correct_side"),
    ],
)
def test_what_a_column_cannot_hold_is_refused(
    change: dict[str, Any], column: str, tmp_path: Path
) -> None:
    table = pairs({"kind": "main"}, change)
    text = refusal(tmp_path, table if "kind" in change else table.drop(columns="kind"))
    assert f"row 3, column {column}:" in text


def test_an_empty_answer_is_left_out_and_said(tmp_path: Path) -> None:
    result = read(tmp_path, pairs({}, {"response": None}, {"response": "NA"}, {"response": 5}))
    assert result.answers["value"].tolist() == [2, 5]
    assert result.notes == ("2 rows are without a response left out.",)


def test_a_condition_may_be_called_na(tmp_path: Path) -> None:
    assert read(tmp_path, pairs({"left": "NA"})).conditions == ("NA", "other")


def test_a_trial_is_a_main_one_unless_the_table_says_otherwise(tmp_path: Path) -> None:
    result = read(tmp_path, pairs({"kind": "practice"}, {"kind": None}))
    assert result.answers["kind"].tolist() == ["practice", "main"]
    assert read(tmp_path, pairs({})).answers["kind"].tolist() == ["main"]


def test_unknown_columns_are_ignored_with_a_note(tmp_path: Path) -> None:
    result = read(tmp_path, pairs({"browser": "x", "emotion": "anger"}))
    assert result.notes == ("Columns that are not read: browser.",)


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    text = refusal(tmp_path, pairs({}).drop(columns=["left", "segment"]))
    assert "column segment, left is missing; there are participant, question" in text


def test_a_column_that_occurs_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="column left occurs twice"):
        read_text(tmp_path, "participant,segment,question,left,right,response,left\n")


def test_an_answer_that_is_stored_twice_is_refused(tmp_path: Path) -> None:
    text = refusal(tmp_path, pairs({"trial": 1}, {"trial": 2}, {"trial": 1}))
    assert "row 4, column trial: the same answer stands in row 2 already" in text


def test_without_trial_numbers_the_same_pair_may_be_answered_again(tmp_path: Path) -> None:
    assert len(read(tmp_path, pairs({}, {})).answers) == 2


def test_a_condition_is_ranked_once_in_a_segment(tmp_path: Path) -> None:
    row = "anna,s1,realism,ours,1\n"
    with pytest.raises(InputError, match=r"row 3, .* stands in row 2 already"):
        read_text(tmp_path, f"participant,segment,question,condition,rank\n{row}{row}", RANKING)


def test_a_ranking_in_practice_may_come_back(tmp_path: Path) -> None:
    rows = "".join(f"anna,s1,realism,ours,1,{kind}\n" for kind in ("practice", "repeat"))
    text = f"participant,segment,question,condition,rank,kind\n{rows}"
    assert len(read_text(tmp_path, text, RANKING).answers) == 2


def test_who_is_marked_as_excluded_is_so_with_the_reason_given(tmp_path: Path) -> None:
    table = pairs(
        {"participant": "anna", "excluded": "false"},
        {"participant": "ben", "excluded": "0"},
        {"participant": "ben", "excluded": "1"},
        {"participant": "cleo", "excluded": "too fast"},
        {"participant": "dan", "excluded": ""},
    )
    assert read(tmp_path, table).marked == {"ben": MARKED, "cleo": "too fast"}


def test_parquet_is_read_like_csv(tmp_path: Path) -> None:
    table = pairs(
        {"participant": 1, "response": 2.0, "set": 1, "excluded": False},
        {"participant": 2, "response": None, "set": 2, "excluded": True},
        {"participant": 2, "response": 5.0, "set": 2, "excluded": True},
    )
    path = tmp_path / "answers.parquet"
    table.to_parquet(path)
    result = read_answers(path, PAIRWISE)
    assert result.participants == ("1", "2")
    assert result.sets == ("1", "2")
    assert result.answers["value"].tolist() == [2, 5]
    assert result.marked == {"2": MARKED}


def test_a_bad_cell_of_parquet_is_named_by_its_row_from_1(tmp_path: Path) -> None:
    path = tmp_path / "answers.parquet"
    pairs({}, {"response": 6}).to_parquet(path)
    with pytest.raises(InputError, match=r"answers\.parquet, row 2, column response"):
        read_answers(path, PAIRWISE)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_other_separators_are_found(separator: str, tmp_path: Path) -> None:
    text = pairs({}, {}).to_csv(index=False, sep=separator)
    assert len(read_text(tmp_path, text).answers) == 2


def test_blank_lines_and_a_byte_order_mark_do_no_harm(tmp_path: Path) -> None:
    text = pairs({}, {"response": 8}).to_csv(index=False).replace("\n", "\n\n", 1)
    with pytest.raises(InputError, match="row 4, column response"):
        read_text(tmp_path, text)


@pytest.mark.parametrize("name", ["answers.csv", "answers.parquet"])
def test_what_is_no_table_is_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with pytest.raises(InputError, match="there is no such file"):
        read_answers(path, PAIRWISE)
    path.write_bytes(b"\xff\xfe\x00\x81 no table\n")
    with pytest.raises(InputError, match="neither CSV in UTF-8 nor Parquet"):
        read_answers(path, PAIRWISE)


def test_a_line_with_too_many_cells_is_refused(tmp_path: Path) -> None:
    text = "participant,segment,question,left,right,response\na,s,q,x,y,1\na,s,q,x,y,1,7\n"
    with pytest.raises(InputError, match="line 3"):
        read_text(tmp_path, text)


def test_own_speech_on_both_sides_is_refused(tmp_path: Path) -> None:
    text = (
        "participant,segment,question,condition,left_speech,right_speech,response\n"
        "anna,s1,fits,ours,own,other,1\nanna,s2,fits,ours,own,own,1\n"
    )
    with pytest.raises(InputError, match="row 3, column right_speech: left_speech and right"):
        read_text(tmp_path, text, MISMATCH)


def test_catch_trials_of_ratings_are_left_out_and_said(tmp_path: Path) -> None:
    text = (
        "participant,segment,question,condition,response,kind\n"
        "anna,s1,match,ours,4,main\nanna,,,,,catch\nanna,,,,,attention\n"
    )
    result = read_text(tmp_path, text, RATING_OF_ONE)
    assert len(result.answers) == 1
    assert len(result.notes) == 2


def ranked(*rows: tuple[str, str, str, float]) -> pd.DataFrame:
    """Rankings by one participant: trial, segment, condition, rank."""
    header = ["trial", "segment", "condition", "rank"]
    return pd.DataFrame(list(rows), columns=header).assign(participant="anna", question="q")


def test_rankings_of_one_segment_in_several_trials_are_kept_apart(tmp_path: Path) -> None:
    table = ranked(
        *(("1", "s1", name, place) for place, name in enumerate("abc", 1)),
        *(("2", "s1", name, place) for place, name in enumerate("bca", 1)),
        *((str(place), "s2", name, place) for place, name in enumerate("abc", 1)),
    )
    result = placements_of(read_table(table, "ranking", tmp_path).answers)

    # Trials that number single rows of a ranking apart tell nothing.
    assert result.given.tolist() == [[1, 2, 3], [3, 1, 2], [1, 2, 3]]
    assert result.averaged().given[0].tolist() == [2, 1.5, 2.5]


def test_rankings_that_leave_places_out_are_noted(tmp_path: Path) -> None:
    table = ranked(("1", "s1", "a", 1), ("1", "s1", "b", 2), ("1", "s1", "c", 4))
    assert read_table(table, "ranking", tmp_path).notes[0].startswith("1 ranking leaves places out")
    tied = table.assign(rank=[1, 1, 3])
    assert read_table(tied, "ranking", tmp_path).notes == ()


def test_rows_that_repeat_others_without_a_trial_are_noted(tmp_path: Path) -> None:
    twice = pd.concat([pairs({}, {"segment": "s2"})] * 2)
    assert read(tmp_path, twice).notes[0].startswith("2 rows are the same as an earlier one")
    assert read(tmp_path, twice.assign(trial=range(4))).notes == ()


def rated(*scores: int) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "participant": [f"p{number}" for number in range(len(scores))],
            "segment": "s1",
            "question": "q",
            "condition": "ours",
            "response": scores,
        }
    )


def test_a_rating_far_above_all_others_is_noted_and_off_a_stated_scale_refused(
    tmp_path: Path,
) -> None:
    table = rated(*[1, 2, 3, 4, 5] * 8, 55)
    assert (
        "The highest rating, 55, was given 1 time" in read_table(table, "rating", tmp_path).notes[0]
    )
    with pytest.raises(InputError, match="row 42, column response: 55 is not on the scale"):
        read_table(table, "rating", tmp_path, scale=(1, 5))
    assert read_table(table[:-1], "rating", tmp_path, scale=(1, 7)).scales == {"q": (1, 7)}


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
