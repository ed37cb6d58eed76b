import json
import shutil
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from sqlalchemy import update

from analysis.report.figures.style import FORMATS
from analysis.results.report import analyse_table, as_json
from studyapp.database.tables.study_session import StudyVersion
from studyapp.results.answers import read_answers
from studyapp.results.report import report
from studyapp.results.report_subject import report_presets
from studyapp.results.stated_beforehand import change_notes, exclusions_of
from studyapp.study.study_file import new_study
from tests.studyapp.results.conftest import Answered
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.stored import writing


def shares(results: dict[str, Any]) -> dict[tuple[str, ...], float]:
    """Return every win share, whichever of two conditions was named first."""
    found: dict[tuple[str, ...], float] = {}
    for one in results["comparisons"]:
        share = one["win_share"]["estimate"]
        found[one["a"], one["b"], one["question"]] = share
        found[one["b"], one["a"], one["question"]] = 1 - share
    return found


def results_of(page: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(page.with_name("results.json").read_text("utf-8"))
    return found


def without_scales(conditions: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return means and other numbers that no scale limits."""
    limited = ("low", "high", "counts", "at_least")
    return [{key: one[key] for key in one if key not in limited} for one in conditions]


ORDER = ["ours", "theirs", "real"]

RESULTS = {
    "rating": ("conditions", "clmm", "contrasts"),
    "ranking": ("conditions", "plackett_luce", "kendall_w"),
    "mismatch": ("conditions", "side_bias", "agreement"),
}


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_study_and_its_reports_table_give_the_same_results(
    answered: Answered, protocol: str
) -> None:
    page = report(answered(protocol, people=3, stop_after=1))
    table = page.parent / "tables" / "answers.csv"
    of_study = results_of(page)
    html = page.read_text("utf-8")
    # Only a report that is asked for it plays motion.
    assert not any(words in html for words in ("motion-viewer", "media-src", 'id="motion"'))
    rows = pd.read_csv(table)
    if "condition" in rows:
        # A table's conditions are in the order of its rows, a study's in that of its file.
        rows = rows.sort_values(
            "condition", kind="stable", key=lambda names: names.map(ORDER.index)
        )
        rows.to_csv(table, index=False)

    of_table = json.loads(as_json(analyse_table(table, protocol).keys()))

    assert of_study["study"]["origin"] == "participants"
    assert of_study["participants"] == of_table["participants"] == {"recruited": 3, "attentive": 2}
    assert of_study["exclusions"] == of_table["exclusions"]
    if protocol == "pairwise":
        assert shares(of_study) == pytest.approx(shares(of_table))
        return
    for key in RESULTS[protocol]:
        if (protocol, key) == ("rating", "conditions"):
            # Only the study knows that its two questions have different scales.
            assert without_scales(of_study[key]) == without_scales(of_table[key])
        else:
            assert of_study[key] == of_table[key]
    if protocol == "mismatch":
        assert of_study["realism"]["protocol"] == "pairwise"
        assert of_study["realism"]["comparisons"]
        assert (table.parent / "realism_answers.csv").exists()


def test_a_study_without_answers_is_reported_as_such(
    answered: Answered, empty_sqlite: Path
) -> None:
    remarks: list[str] = []
    folder = answered("mismatch", people=0)
    shutil.copyfile(empty_sqlite, folder.responses)
    page = report(folder, with_motion=True, warn=remarks.append)

    text = page.read_text("utf-8")
    assert "No participant has answered yet" in text
    assert "Nobody has compared two conditions yet." in text
    found = results_of(page)
    assert found["study"]["origin"] == "none"
    assert found["remark"]
    assert found["participants"] == {"recruited": 0, "attentive": 0}
    hint = "If the study is served with DATABASE_URL, set it here as well."
    assert remarks == [f"No answers of participants were found. {hint}"]


def test_reports_are_reproducible_and_replace_older_files(
    answered: Answered, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.report.page.FORMATS", FORMATS)
    folder = answered("ranking")
    stale = folder.report / "tables" / "earlier.csv"
    stale.parent.mkdir(parents=True)
    stale.write_text("x\n", "utf-8")
    runs = []
    for _ in range(2):
        report(folder)
        files = sorted(path for path in folder.report.rglob("*") if path.is_file())
        runs.append({str(path): path.read_bytes() for path in files})

    assert runs[0] == runs[1]
    assert str(stale) not in runs[0]


@pytest.mark.parametrize(
    ("template", "measured"),
    [
        ("pairwise", ("report", "amuse")),
        ("mismatch", ("report", "genea")),
        ("three-systems", ("report", "amuse", "diffsheg", "s2ue")),
    ],
)
def test_a_report_has_the_metrics_of_the_papers_that_a_study_follows(
    tmp_path: Path, template: str, measured: tuple[str, ...]
) -> None:
    study = new_study(tmp_path / "study.toml", template=template, name="study")
    assert report_presets(study) == measured


CHANGED = """
[[exclusions]]
rule = "incomplete"
[[exclusions]]
rule = "attention"
more_than = 2
[[exclusions]]
rule = "straight_lining"
at_least = 1
trials = 500
"""


def test_unfinished_sessions_are_excluded_and_unstated_rules_are_exploratory(
    answered: Answered,
) -> None:
    folder = answered("rating", people=3, stop_after=2)
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(f"margin = 0.5\n{text}{CHANGED}", "utf-8")

    page = report(folder)

    found = results_of(page)
    assert [(rule["rule"], rule["exploratory"]) for rule in found["rules"]] == [
        ("incomplete", False),
        ("attention", True),
        ("straight_lining", True),
    ]
    [flow] = found["flow"]
    assert (flow["places"], flow["opened"], flow["completed"], flow["answered"]) == (3, 3, 2, 3)
    assert "2 of 3 trials" in found["exclusions"]["3"]
    assert found["rules"][2]["remark"] == (
        "cannot be applied: no question has 500 answers that could be alike"
    )
    html = page.read_text("utf-8")
    assert (
        "Fewer people than planned have taken part (2 of 3 places are filled), and the numbers"
        in html
    )
    for change in (
        "attention&gt;2 and straight_lining&gt;=1,trials=500 was added to the study file after",
        "attention&gt;1 was removed from the study file after",
        "margin of 0.5 was set after",
    ):
        assert f"{change} the first participant arrived" in html

    planned = exclusions_of(folder.study(), read_answers(folder, "participants")).planned
    assert any("more than 1 attention" in rule.description for rule in planned)
    # What was stated before the first participant came is not known then.
    with writing(folder.responses) as session:
        session.execute(update(StudyVersion).values(definition="protocol = 'of earlier times'"))
    study, answers = folder.study(), read_answers(folder, "participants")
    exclusions = exclusions_of(study, answers)
    assert exclusions.planned == ()
    assert all(rule.exploratory for rule in exclusions.rules)
    (note,) = (*exclusions.notes, *change_notes(study, answers.stated))
    assert note.startswith("The study file of the first participant cannot be read")
