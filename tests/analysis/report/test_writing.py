from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from analysis.report import KnownShare, write_report
from analysis.report.inputs import ReportInputs
from analysis.responses import responses_frame
from motion.errors import InputError

HOSTILE = '<script>alert("x")</script> & $\\frac{1}{2}$ #_%'


def text_of(element):
    return re.sub(r"\s+", " ", element.get_text(" ", strip=True)).replace("\u00a0", " ")


def cells_of(page, anchor, number=0):
    """Return the body of a section's table as text."""
    table = page.find(id=anchor).find_all("table")[number]
    return [[text_of(cell) for cell in row(["th", "td"])] for row in table.tbody("tr")]


def test_the_first_screen_answers_with_numbers_worked_by_hand(by_hand, report_page):
    page = report_page(by_hand)
    first, basis = page.find(class_="answer")("p")
    # Win share (1 + 1 + 1 + .5 + 0 + 1) / 6 = .75; df 1 makes the interval the whole range.
    assert text_of(first) == (
        "On synchronisation, the answers do not decide between ours and other (win share of ours "
        ".75, 95% interval [.00, 1.00])."
    )
    assert text_of(basis) == (
        "This rests on 6 answers by 3 of 4 participants about 2 segments of 1 speaker; had nobody "
        "been excluded, every conclusion would be the same."
    )
    assert text_of(page.find(class_="flow")) == (
        "Participants: 4 answered − 1 failed a catch trial = 3 analysed."
    )


def test_the_tables_hold_numbers_worked_by_hand(by_hand, report_page):
    page = report_page(by_hand)
    assert cells_of(page, "counts") == [["other", "67", "17", "17"]]
    assert cells_of(page, "counts", 1) == [
        ["synchronisation", "other", "6", "2 (33)", "2 (33)", "1 (17)", "1 (17)", "0 (0)"]
    ]
    [row] = cells_of(page, "win-shares")
    assert row[2] == ".75 [.00, 1.00]"
    assert row[5:] == ["3 × 2", ".56 [.00, 1.00]", row[7], "4 × 2"]
    assert cells_of(page, "flow") == [["other", "4", "0", "1", "3"]]
    assert cells_of(page, "flow", 1) == [
        ["s4", "other", "failed catch trials", "1 catch trial failed"]
    ]


def test_the_larger_sum_is_marked_by_weight(by_hand, report_page):
    strong = report_page(by_hand).find(id="counts").table("strong")
    assert [text_of(cell) for cell in strong] == ["67"]


def test_the_csv_tables_agree_with_the_page(by_hand, tmp_path):
    write_report(by_hand, tmp_path)
    tables = {path.name: pd.read_csv(path) for path in (tmp_path / "tables").glob("*.csv")}
    assert set(tables) >= {
        "participant_flow.csv",
        "preferences.csv",
        "counts.csv",
        "exclusions.csv",
        "metrics.csv",
        "responses_analysed.csv",
    }
    assert all((table["origin"] == "participants").all() for table in tables.values())
    shares = tables["preferences.csv"].set_index("exclusions")["win_share"]
    assert shares["applied"] == pytest.approx(0.75)
    assert shares["none"] == pytest.approx(4.5 / 8)
    assert len(tables["responses_analysed.csv"]) == 6
    assert "s4" not in set(tables["responses_analysed.csv"]["study_session"])
    assert tables["counts.csv"]["ours_percent"].tolist() == [pytest.approx(400 / 6)]


def test_the_latex_table_is_booktabs_with_the_same_numbers(by_hand, tmp_path):
    write_report(by_hand, tmp_path)
    latex = (tmp_path / "tables" / "preferences.tex").read_text(encoding="utf-8")
    assert r"other & \textbf{67} & 17 & .75~[.00,~1.00] \\" in latex
    for rule in (r"\toprule", r"\midrule", r"\bottomrule", r"\cmidrule(lr){2-4}"):
        assert rule in latex
    assert latex.count("{") == latex.count("}")


def test_the_page_needs_nothing_from_outside(simulated_study, report_page):
    page = report_page(simulated_study(participants=6, segments=8).inputs())
    assert not page.find_all(["script", "link", "iframe", "object", "img"])
    for element in page.find_all(True):
        for name, value in element.attrs.items():
            if name in {"href", "xlink:href", "src", "action"}:
                assert re.match(r"#|tables/[\w.]+$", value), f"{element.name} {name}={value}"
            assert not name.startswith("on")
    style = " ".join(element.get_text() for element in page("style"))
    assert "@import" not in style
    assert not re.search(r"url\((?!#)", str(page))
    policy = page.find("meta", attrs={"http-equiv": "Content-Security-Policy"})["content"]
    assert "default-src 'none'" in policy


def test_every_id_is_one_of_a_kind_and_every_reference_finds_its_own(simulated_study, report_page):
    page = report_page(simulated_study(participants=6, segments=8).inputs())
    ids = [element["id"] for element in page.find_all(id=True)]
    assert len(ids) == len(set(ids))
    wanted = {e["href"][1:] for e in page.find_all(href=re.compile("^#"))}
    wanted |= {e["xlink:href"][1:] for e in page.find_all(attrs={"xlink:href": True})}
    wanted |= {e["aria-labelledby"] for e in page.find_all(attrs={"aria-labelledby": True})}
    wanted |= set(re.findall(r"url\(#([^)]+)\)", str(page)))
    assert wanted <= set(ids)


def test_tables_and_figures_speak_to_those_who_cannot_see_them(simulated_study, report_page):
    page = report_page(simulated_study(participants=6, segments=8).inputs())
    assert page.html["lang"] == "en"
    for header in page.find_all("th"):
        assert header["scope"] in {"row", "col", "colgroup"}
    pictures = page.find_all("svg")
    assert len(pictures) == 3
    for picture in pictures:
        assert picture["role"] == "img"
        assert "win share" in picture["aria-label"].lower()
    assert page.find("svg").find("title").get_text().endswith("%)")
    for figure in page.find_all("figure"):
        assert figure.figcaption.get_text(strip=True)


def test_a_rehearsal_says_so_in_every_part(simulated_study, report_page):
    truth = {
        (f"rule_based_vs_{other}", question): KnownShare(share=0.6, on_these_segments=0.7)
        for other in ("mismatched", "static")
        for question in ("emotion", "synchronisation")
    }
    study = simulated_study(participants=6, segments=8)
    page = report_page(study.inputs(origin="rehearsal", truth=truth))
    assert "rehearsal" in page.title.get_text()
    assert "Rehearsal" in page.find(class_="banner").get_text()
    assert "@top-center" in page.style.get_text()
    for part in [*page("h2"), *page("figcaption")]:
        assert "rehearsal" in part.get_text().lower()
    for picture in page("svg"):
        assert "Rehearsal" in picture.get_text()
    assert "simulated raters" in text_of(page.find(class_="answer"))
    assert "participants preferred" not in text_of(page)
    rows = cells_of(page, "truth")
    assert len(rows) == 4
    assert {row[2] for row in rows} == {".60"}
    assert {row[4] for row in rows} <= {"inside", "outside"}
    assert {row[5] for row in rows} == {".70"}


def test_real_answers_are_not_called_a_rehearsal(simulated_study, report_page):
    page = report_page(simulated_study(participants=6, segments=8).inputs())
    assert "rehearsal" not in page.get_text().lower()
    assert page.find(class_="banner") is None
    assert page.find(id="truth") is None


def test_without_participants_the_page_says_so_and_shows_no_preference(
    simulated_study, report_page
):
    page = report_page(simulated_study().inputs(origin="none", responses=responses_frame([])))
    assert "No participant has answered yet" in text_of(page.find(class_="answer"))
    assert page.find("svg") is None
    assert page.find(id="win-shares") is None
    assert page.find(id="metrics") is not None


def test_when_nobody_passes_the_rules_there_is_no_result(simulated_study, report_page):
    study = simulated_study(participants=3, inattentive=0, unfinished=3, segments=6)
    page = report_page(study.inputs())
    assert "None of the 6 study sessions passed" in text_of(page.find(class_="answer"))
    assert {row[2] for row in cells_of(page, "win-shares")} == {"– (no answers)"}
    assert page.find("svg") is None
    assert page.find(id="flow") is not None
    assert page.find(id="counts") is page.find(id="emotions") is None


def test_a_comparison_that_nobody_has_answered_is_shown_as_such(by_hand, report_page):
    page = report_page(ReportInputs(**(vars(by_hand) | {"conditions": ("ours", "other", "third")})))
    assert [row[1:3] for row in cells_of(page, "win-shares")] == [
        ["other", ".75 [.00, 1.00]"],
        ["third", "– (no answers)"],
    ]
    assert cells_of(page, "flow")[1] == ["third", "0", "0", "0", "0"]


def test_hostile_names_are_text_and_nothing_else(by_hand, tmp_path, open_page):
    renamed = by_hand.responses.replace({"other": HOSTILE})
    inputs = ReportInputs(
        **(
            vars(by_hand)
            | {
                "title": HOSTILE,
                "responses": renamed,
                "conditions": ("ours", HOSTILE),
                "notes": (HOSTILE,),
                "questions": {"synchronisation": HOSTILE},
            }
        )
    )
    page = open_page(write_report(inputs, tmp_path))
    assert page.find("script") is None
    assert text_of(page.h1) == HOSTILE
    assert HOSTILE.replace("_", " ") in text_of(page.find(id="win-shares"))
    latex = (tmp_path / "tables" / "preferences.tex").read_text(encoding="utf-8")
    assert r"\$\textbackslash{}frac" in latex


@pytest.mark.slow
def test_the_same_inputs_give_the_same_bytes_in_any_process(tmp_path):
    program = (
        "import importlib.util, sys\n"
        "from pathlib import Path\n"
        "spec = importlib.util.spec_from_file_location('studies', sys.argv[1])\n"
        "studies = importlib.util.module_from_spec(spec)\n"
        "sys.modules['studies'] = studies\n"
        "spec.loader.exec_module(studies)\n"
        "from analysis.report import write_report\n"
        "study = studies.SimulatedStudy(participants=5, segments=8)\n"
        "write_report(study.inputs(), Path(sys.argv[2]))\n"
    )
    studies = Path(__file__).parents[1] / "conftest.py"
    written = []
    for seed in ("1", "2"):
        folder = tmp_path / seed
        subprocess.run(
            [sys.executable, "-c", program, studies, folder],
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        written.append({path.relative_to(folder): path.read_bytes() for path in files})
    assert written[0] == written[1]


def test_inputs_that_contradict_each_other_are_refused(simulated_study):
    study = simulated_study(participants=4, segments=4)
    with pytest.raises(InputError, match="origin 'none'"):
        study.inputs(origin="none")
    with pytest.raises(InputError, match="origin 'participants' has 0 answers"):
        study.inputs(responses=responses_frame([]))
    with pytest.raises(InputError, match="'emotion', which the study does not ask"):
        study.inputs(questions={"synchronisation": "?"})
