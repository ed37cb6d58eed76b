from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from analysis.answers.cells import read_cells
from analysis.answers.reading import MARKED, read_answers
from analysis.answers.table import MISMATCH, PAIRWISE, RANKING, RATING_OF_ONE, AnswerTable, Layout
from analysis.results.headline import placements_of
from motion.errors import InputError
from motion.files import write_frame
from tests.analysis.results.made_tables import crossed, read_table

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


def read_text(folder: Path, text: str, layout: Layout = PAIRWISE) -> AnswerTable:
    path = folder / "answers.csv"
    path.write_text(text, "utf-8-sig")
    return read_answers(path, layout)


def test_names_keep_the_tables_order(tmp_path: Path) -> None:
    result = read(
        tmp_path,
        pairs(
            {"kind": "catch", "left": "broken", "right": "truth", "correct_side": "right"},
            {"kind": "practice", "left": "zebra", "right": "ours", "question": "b"},
            {"kind": "main", "left": "ours", "right": "apple", "question": "a"},
            # A trial is a main trial unless its kind is stated.
            {"kind": None, "left": "apple", "right": "zebra", "question": "b"},
        ),
    )
    assert result.conditions == ("zebra", "ours", "apple")
    assert result.questions == ("b", "a")
    assert result.participants == ("anna",)
    assert result.answers["kind"].tolist() == ["catch", "practice", "main", "main"]
    assert not result.has_sets


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
        ({"watched": 1.5}, "watched"),
        ({"kind": "catch"}, "correct_side"),
        ({"kind": "catch", "correct_side": "up"}, "correct_side"),
    ],
)
def test_invalid_values_of_a_column_are_refused(
    change: dict[str, Any], column: str, tmp_path: Path
) -> None:
    table = pairs({"kind": "main"}, change)
    with pytest.raises(InputError, match=rf"^answers\.csv, row 3, column {column}:"):
        read(tmp_path, table if "kind" in change else table.drop(columns="kind"))


def test_empty_answers_and_unknown_columns_are_skipped_with_a_note(tmp_path: Path) -> None:
    table = pairs({}, {"response": None}, {"response": "NA"}, {"response": 5, "left": "NA"})
    result = read(tmp_path, table.assign(browser="x", emotion="anger"))
    assert result.answers["value"].tolist() == [2, 5]
    # A name may well be NA.
    assert result.conditions == ("ours", "other", "NA")
    assert result.notes == (
        "Columns that are not read: browser.",
        "2 rows are left out for lack of a response.",
    )


HEADER = "participant,segment,question,"
RANKING_TWICE = "condition,rank\nanna,s1,realism,ours,1\nanna,s1,realism,ours,1\n"
STORED_TWICE = "left,right,response,trial\n" + "".join(f"a,s,q,x,y,1,{n}\n" for n in (1, 2, 1))
TOO_MANY_CELLS = "left,right,response\na,s,q,x,y,1\na,s,q,x,y,1,7\n"
OWN_SPEECH_TWICE = (
    "condition,left_speech,right_speech,response\n"
    "anna,s1,fits,ours,own,other,1\nanna,s2,fits,ours,own,own,1\n"
)


@pytest.mark.parametrize(
    ("text", "layout", "problem"),
    [
        ("right,response\n", PAIRWISE, "the table has no column left; it has participant, segment"),
        ("left,right,response,left\n", PAIRWISE, "column left occurs twice"),
        (STORED_TWICE, PAIRWISE, "row 4, column trial: row 2 already holds this answer"),
        (RANKING_TWICE, RANKING, r"row 3, .*row 2 already holds this answer"),
        (TOO_MANY_CELLS, PAIRWISE, "line 3"),
        (OWN_SPEECH_TWICE, MISMATCH, "row 3, column right_speech: left_speech and right"),
    ],
)
def test_contradictions_are_refused_with_their_position(
    text: str, layout: Layout, problem: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=problem):
        read_text(tmp_path, HEADER + text, layout)


def test_a_practice_ranking_may_be_repeated(tmp_path: Path) -> None:
    rows = "".join(f"anna,s1,realism,ours,1,{kind}\n" for kind in ("practice", "repeat"))
    text = f"participant,segment,question,condition,rank,kind\n{rows}"
    assert len(read_text(tmp_path, text, RANKING).answers) == 2


def test_participants_marked_as_excluded_are_excluded_with_the_given_reason(tmp_path: Path) -> None:
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
    pairs({}, {"response": 6}).to_parquet(path)
    with pytest.raises(InputError, match=r"answers\.parquet, row 2, column response"):
        read_answers(path, PAIRWISE)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_other_separators_blank_lines_and_a_byte_order_mark_are_accepted(
    separator: str, tmp_path: Path
) -> None:
    text = pairs({}, {"response": 8}).to_csv(index=False, sep=separator)
    with pytest.raises(InputError, match="row 4, column response"):
        read_text(tmp_path, text.replace("\n", "\n\n", 1))


@pytest.mark.parametrize("name", ["answers.csv", "answers.parquet"])
def test_files_that_are_not_tables_are_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with pytest.raises(InputError, match="there is no such file"):
        read_answers(path, PAIRWISE)
    path.write_bytes(b"\xff\xfe\x00\x81 no table\n")
    with pytest.raises(InputError, match="neither CSV in UTF-8 nor Parquet"):
        read_answers(path, PAIRWISE)


def test_catch_trials_of_ratings_are_left_out_and_reported(tmp_path: Path) -> None:
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

    # Trial numbers that differ within a ranking carry no information.
    assert result.given.tolist() == [[1, 2, 3], [3, 1, 2], [1, 2, 3]]
    assert result.averaged().given[0].tolist() == [2, 1.5, 2.5]


def test_skipped_ranks_and_repeated_rows_without_a_trial_are_noted(tmp_path: Path) -> None:
    gaps = ranked(("1", "s1", "a", 1), ("1", "s1", "b", 2), ("1", "s1", "c", 4))
    assert read_table(gaps, "ranking", tmp_path).notes[0].startswith("1 ranking leaves places out")
    assert read_table(gaps.assign(rank=[1, 1, 3]), "ranking", tmp_path).notes == ()
    twice = pd.concat([pairs({}, {"segment": "s2"})] * 2)
    assert read(tmp_path, twice).notes[0].startswith("2 rows are the same as an earlier one")
    assert read(tmp_path, twice.assign(trial=range(4))).notes == ()


def test_an_outlying_rating_is_noted_and_one_off_the_stated_scale_refused(tmp_path: Path) -> None:
    scores = [1, 2, 3, 4, 5] * 8 + [55]
    table = crossed(41, 1, condition=["ours"]).assign(question="q", response=scores)
    notes = read_table(table, "rating", tmp_path).notes
    assert "The highest rating, 55, was given 1 time" in notes[0]
    with pytest.raises(InputError, match="row 42, column response: 55 is not on the scale"):
        read_table(table, "rating", tmp_path, scale=(1, 5))
    assert read_table(table[:-1], "rating", tmp_path, scale=(1, 7)).scales == {"q": (1, 7)}


def test_the_reports_table_runs_no_formula_and_is_read_back_unchanged(tmp_path: Path) -> None:
    path, names = tmp_path / "t.csv", [FORMULA, "'tis", "-x", "plain"]
    write_frame(path, pd.DataFrame({"participant": names, "share": [-0.5, 1.0, 0.0, 1.0]}))

    plain = pd.read_csv(path)
    assert plain["participant"].tolist() == ["'" + FORMULA, "''tis", "'-x", "plain"]
    assert plain["share"].tolist() == [-0.5, 1.0, 0.0, 1.0]
    cells = read_cells(path, ["participant"], ["participant"])
    assert cells.rows["participant"].tolist() == names
