import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest

from studyapp.database.tables.researchers import Event
from studyapp.researchers.audit import log_change
from studyapp.results.export.columns import (
    ANSWERS,
    FORM,
    LOG,
    PARTICIPANTS,
    RECRUITER_IDS,
    REFUSALS,
    WATCHING,
    TableColumns,
)
from studyapp.results.export.tables import Exported, export
from studyapp.study.folder import StudyFolder
from tests.studyapp.results.export.people import FORMULA, NAMES, secrets_of, text_of
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.stored import writing
from tests.support.studies.taking_part_steps import SetClock

Answered = Callable[[str], StudyFolder]

Made = tuple[StudyFolder, Exported]

TABLES = (ANSWERS, PARTICIPANTS, FORM, WATCHING, REFUSALS, LOG)


def read(folder: Path, table: TableColumns = ANSWERS) -> pd.DataFrame:
    name = f"answers_{table.name}" if table.name else "answers"
    return pd.read_csv(folder / f"{name}.csv", keep_default_na=False, na_values=[""])


@pytest.fixture(scope="module")
def made(recruited_once: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Return a study and its complete export, which tests do not change."""
    root = tmp_path_factory.mktemp("exported")
    folder = StudyFolder(shutil.copytree(recruited_once("pairwise"), root / "study"))
    out = root / "out" / "answers.csv"
    return folder, export(folder, out, with_recruiter_ids=True)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_codebook_has_every_column_value_and_question(
    answered: Answered, protocol: str, tmp_path: Path
) -> None:
    out = tmp_path / "out" / "answers.csv"
    folder = answered(protocol)

    export(folder, out.with_suffix(".parquet"))
    typed = out.parent.glob("*.parquet")
    schemas = {path.stem: pq.read_schema(path) for path in typed}
    export(folder, out, with_recruiter_ids=True)

    book = json.loads(out.with_name("answers_codebook.json").read_text("utf-8"))
    described = {
        file: {column["name"]: column for column in table["columns"]}
        for table in book["tables"]
        for file in table["files"]
    }
    page = out.with_name("answers_codebook.md").read_text("utf-8")
    files = sorted(out.parent.glob("*.csv"))
    assert {path.name for path in files} == set(described)
    assert len(files) == len(TABLES) + 1 == len(schemas) + 1
    for path in files:
        about = described[path.name]
        if schema := schemas.get(path.stem):
            assert schema.names == list(about)
            assert all(schema.field(name).metadata[b"meaning"] for name in about)
        cells = pd.read_csv(path, dtype=str, keep_default_na=False)
        assert list(cells.columns) == list(about)
        for name, column in about.items():
            assert column["meaning"] and f"| `{name}` |" in page
            if not column["missing"]:
                assert (cells[name] != "").all(), (path.name, name)
            if column["values"] and name not in ("part", "condition"):
                given = {cell.removeprefix("'") for cell in cells[name]} - {""}
                assert given <= set(column["values"]), (path.name, name)
    wording = {question["name"]: question for question in book["questions"]}
    answers = read(out.parent)
    for question in folder.study().questions:
        entry = wording[question.name]
        assert entry["text"] == question.text
        assert set(entry["reasons"]) == set(question.reason_names)
        for value in answers.loc[answers["question"] == question.name, "value"]:
            assert any(_covers(label, int(value)) for label in entry["values"])


def _covers(label: str, value: int) -> bool:
    """Tell whether ``3``, ``20 to 39`` or ``2 and on`` is said of `value`."""
    low, _, high = label.replace(" and on", " to 1000").partition(" to ")
    return int(low) <= value <= int(high or low)


def test_exports_contain_nothing_that_identifies_a_participant(made: Made) -> None:
    folder, done = made
    ids = done.files[0].with_name("recruiter_ids.csv")

    text = text_of([file for file in done.files if file != ids])

    assert {name for name in (*NAMES, *secrets_of(folder)) if name in text} == set()
    table = pd.read_csv(ids)
    assert list(table.columns) == list(RECRUITER_IDS.names)
    assert table["recruiter_participant"].tolist() == [NAMES[0]]
    people = read(ids.parent, PARTICIPANTS)
    assert table["participant"].tolist() == people["participant"].tolist()[2:]
    assert ids.stat().st_mode & 0o777 == 0o600


def test_a_participant_has_one_pseudonym_in_all_tables_and_exports(
    made: Made, tmp_path: Path
) -> None:
    folder, first = made[0], made[1].files[0].parent
    export(folder, tmp_path / "answers.csv")

    for name in ("answers.csv", "answers_participants.csv"):
        assert (tmp_path / name).read_bytes() == (first / name).read_bytes()
    people = read(first, PARTICIPANTS).set_index("study_session")["participant"]
    assert people.is_unique and len(people) == 3
    for table in (ANSWERS, FORM, WATCHING):
        rows = read(first, table)
        assert (rows["participant"] == rows["study_session"].map(people)).all()
    assert folder.pseudonym_key.stat().st_mode & 0o777 == 0o600


def test_each_answer_states_whether_and_by_which_rule_it_is_excluded(made: Made) -> None:
    out = made[1].files[0].parent
    people = read(out, PARTICIPANTS)
    assert people["excluded"].tolist()[:2] == [False, True]
    # The third has answered nothing.
    assert people["excluded"].isna().tolist() == [False, False, True]
    assert people["exclusion_rule"].tolist()[1] == "incomplete"
    assert people["exclusion_kind"].tolist()[1] == "planned"
    answers = read(out)
    kept = answers[answers["study_session"] == 1]
    assert set(kept.loc[kept["analysed"], "kind"]) == {"main", "repeat"}
    assert set(kept.loc[~kept["analysed"], "kind"]) == {"practice", "catch", "attention"}
    assert set(kept["watched_each"]) == {"1.0 1.0"}
    assert (set(kept["times_played"]), set(kept["stalls"])) == ({1.0}, {0})
    left_out = answers[answers["study_session"] == 2]
    assert not left_out["analysed"].any()
    assert left_out["exclusion_reason"].tolist() == ["1 of 6 trials answered"]


def test_spreadsheet_formulas_are_exported_as_text(answered: Answered, tmp_path: Path) -> None:
    folder = answered("pairwise")
    with writing(folder.responses) as session:
        log_change(session, SetClock().now(), Event.EXCLUDED, by="@ada", reason="+1")

    for ending in ("parquet", "csv"):
        export(folder, tmp_path / f"answers.{ending}")

    said = read(tmp_path, FORM).set_index("question")["value"]
    assert said.to_dict()["comment"] == "'" + FORMULA
    assert read(tmp_path, LOG)["researcher"].dropna().tolist() == ["'@ada"]
    typed = pd.read_parquet(tmp_path / "answers_form.parquet")
    assert FORMULA in typed["value"].tolist()
