from __future__ import annotations

import csv

import pytest

from analysis.responses import COLUMNS, read_responses, responses_frame
from motion.errors import InputError


def write_rows(path, rows, columns=COLUMNS):
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    return path


def test_a_written_table_reads_back_as_it_was(tmp_path, simulated_study):
    responses = simulated_study(participants=2, segments=4, practice=1).responses()
    responses.to_csv(tmp_path / "responses.csv", index=False)
    assert read_responses(tmp_path / "responses.csv").equals(responses)


def test_an_empty_table_keeps_every_column_and_its_type():
    frame = responses_frame([])
    assert tuple(frame.columns) == COLUMNS
    assert frame["value"].dtype == "int64"
    assert frame.empty


def test_further_columns_are_ignored_and_order_does_not_matter(tmp_path, answer):
    path = write_rows(
        tmp_path / "r.csv", [answer() | {"remark": "x"}], ["remark", *reversed(COLUMNS)]
    )
    assert tuple(read_responses(path).columns) == COLUMNS


def test_a_table_without_attention_checks_need_not_have_their_column(tmp_path, answer):
    columns = [name for name in COLUMNS if name != "instructed"]
    path = write_rows(tmp_path / "r.csv", [answer()], columns)
    assert read_responses(path)["instructed"].tolist() == [""]


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("value", "3", "less than or equal to 2"),
        ("value", "1.5", "integer"),
        ("value", "", "integer"),
        ("watched", "1.2", "less than or equal to 1"),
        ("watched", "nan", "1"),
        ("seconds", "inf", "finite"),
        ("kind", "warmup", "'practice', 'main', 'repeat', 'catch' or 'attention'"),
        ("position", "0", "greater than or equal to 1"),
        ("answered_at", "2026-11-21T09:00:00", "timezone"),
        ("question", "", "at least 1 character"),
    ],
)
def test_a_bad_value_is_named_with_file_line_and_column(tmp_path, answer, column, value, said):
    rows = [answer(), answer(position=2) | {column: value}]
    path = write_rows(tmp_path / "r.csv", rows)
    with pytest.raises(InputError) as caught:
        read_responses(path)
    assert f"{path}, line 3, column {column}" in str(caught.value)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"left_condition": "third"}, "not the reference and the other"),
        ({"left_condition": "other"}, "not the reference and the other"),
        ({"expected": "left"}, "only for catch trials"),
        ({"kind": "attention"}, "instructed is for attention checks"),
        ({"instructed": "1"}, "instructed is for attention checks"),
        ({"kind": "catch"}, "expected is not the side opposite"),
        ({"kind": "catch", "expected": "right"}, "expected is not the side opposite"),
        ({"kind": "catch", "other": "broken", "expected": "left"}, "one of them 'other'"),
    ],
)
def test_columns_must_fit_together(answer, changes, said):
    with pytest.raises(InputError, match=said):
        responses_frame([answer(**changes)])


def test_a_catch_trial_may_show_another_reference(answer):
    frame = responses_frame(
        [
            answer(
                kind="catch",
                other="broken",
                left_condition="broken",
                right_condition="ground_truth",
                expected="right",
            )
        ]
    )
    assert frame["expected"].tolist() == ["right"]


def test_the_same_answer_twice_is_refused_and_both_places_are_named(tmp_path, answer):
    path = write_rows(tmp_path / "r.csv", [answer(), answer(position=2), answer(value=1)])
    with pytest.raises(InputError, match=r"line 4.*twice.*line 2"):
        read_responses(path)


def test_missing_columns_are_named(tmp_path, answer):
    path = write_rows(tmp_path / "r.csv", [answer()], [c for c in COLUMNS if c != "watched"])
    with pytest.raises(InputError, match="line 1: column watched is missing"):
        read_responses(path)


def test_a_file_that_is_no_csv_is_refused_with_its_name(tmp_path):
    (tmp_path / "r.csv").write_bytes(b"\xff\xfe\x00binary")
    with pytest.raises(InputError, match=r"r\.csv"):
        read_responses(tmp_path / "r.csv")
    with pytest.raises(InputError, match="cannot be read"):
        read_responses(tmp_path)
    with pytest.raises(InputError, match="no such file"):
        read_responses(tmp_path / "none.csv")
