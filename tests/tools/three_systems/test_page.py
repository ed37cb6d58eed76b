from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from motion.segment import Segment, write_segments
from studyapp.study.folder import StudyFolder
from studyapp.study.study_file import new_study
from tools.markdown import marks, with_part
from tools.three_systems.line import Line, Took
from tools.three_systems.page import measured

PAGE = Path(__file__).parents[3] / "docs" / "three-systems.md"


def results_of(conditions: list[str], questions: list[str]) -> dict[str, Any]:
    values = {name: float(place) for place, name in enumerate(conditions)}
    metric = "mean absolute error (MALE, s2ue)"
    return {
        "participants": {"recruited": 60, "attentive": 51},
        "questions": questions,
        "conditions_shown": conditions,
        "bradley_terry": {
            question: {
                "conditions": [
                    {"condition": name, "estimate": value, "low": value, "high": value}
                    for name, value in values.items()
                ]
            }
            for question in questions
        },
        "metrics": {
            "conditions": [
                {
                    "condition": name,
                    "metric": metric,
                    "value": None if name == "amuse" else 4.25,
                    "unit": "mm",
                    "better": "lower",
                    "reason": "the clip has no face" if name == "amuse" else "",
                    "remark": "",
                }
                for name in conditions
            ]
        },
        "metrics_against_people": {
            question: {"metrics": [{"metric": metric, "kendall": {"estimate": -0.6}}]}
            for question in questions
        },
    }


@pytest.fixture
def study(tmp_path: Path) -> StudyFolder:
    folder = StudyFolder(tmp_path)
    made = new_study(folder.definition, template="three-systems", name="study")
    folder.speech.mkdir()
    (folder.speech / "one.wav").touch()
    write_segments(
        folder.speech,
        [Segment(name="one", wav="one.wav", start=0, end=1, speaker="ada", emotion="anger")],
    )
    folder.report.mkdir()
    results = results_of(list(made.conditions), [question.name for question in made.questions])
    (folder.report / "results.json").write_text(json.dumps(results))
    return folder


def test_the_page_shows_the_reports_results(study: StudyFolder) -> None:
    text = measured(study, {"motionjury render study": Took(seconds=9, processor=240)}, [])
    assert "60 simulated participants took part over HTTP, and 51 of them are analysed" in text
    assert "| `amuse` | 0.50 | 1.00 [1.00, 1.00] | −0.50 | 1.00 [1.00, 1.00] |" in text
    assert "| MALE, mm | ↓ | 4.25 | – | 4.25 | 4.25 | 4.25 | 4.25 | −0.60 | −0.60 | −0.60 |" in text
    assert "- Speech2UnifiedExpressions' MALE of `amuse`: the clip has no face." in text
    assert "| `motionjury render study` | 4 min |" in text


def test_text_around_the_measurements_is_kept() -> None:
    page, (begin, end) = PAGE.read_text("utf-8"), marks("measured")
    before, after = page.split(begin)[0], page.split(end)[1]
    assert with_part(page, "measured", "new") == f"{before}{begin}\nnew\n{end}{after}"
    with pytest.raises(InputError, match="no marks"):
        with_part("another page", "measured", "new")


INIT = ("init", "made", "--template", "three-systems")


def test_a_command_reruns_only_if_its_inputs_changed(
    tmp_path: Path,
) -> None:
    line = Line(tmp_path)
    line.run(*INIT, of="first")
    line.run(*INIT, of="first")
    (took,) = line.took().values()
    assert (tmp_path / "made" / "study.toml").exists()
    assert took.seconds > 0 and took.processor > 0
    with pytest.raises(InputError, match=r"'motionjury init made .*' failed"):
        line.run(*INIT, of="second")


def test_an_interrupted_step_is_repeated_and_its_time_is_kept(tmp_path: Path) -> None:
    line = Line(tmp_path)
    with pytest.raises(KeyboardInterrupt), line.step("import") as is_due:
        assert is_due
        raise KeyboardInterrupt
    before = line.took()["import"].seconds
    with line.step("import") as is_due:
        assert is_due
    assert line.took()["import"].seconds > before > 0
    with line.step("import") as is_due:
        assert not is_due
