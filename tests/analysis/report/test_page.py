import re
from pathlib import Path

import pytest
from bs4 import BeautifulSoup

from analysis.report.page import write_report
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import TABLES, pairwise_table, report_of

HOSTILE = '<script>alert("x")</script> & $\\frac{1}{2}$ #_%'


@pytest.fixture(scope="module", params=list(TABLES))
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a report of each protocol, with labels for conditions named `xx_…`."""
    written = tmp_path_factory.mktemp(request.param)
    table = TABLES[request.param](participants=5, segments=4)
    columns = [name for name in ("left", "right", "condition") if name in table]
    table[columns] = "xx_" + table[columns]
    report = report_of(table, request.param, written)
    labels = {name: label_of(name) for name in report.conditions_shown}
    write_report(report, subject_of(report, labels=labels), written)
    return written


def label_of(condition: str) -> str:
    return f"Label_{condition[3:]} (full)"


@pytest.fixture(scope="module")
def page(folder: Path) -> BeautifulSoup:
    """Return its page."""
    return opened(folder / "report.html")


def opened(path: Path) -> BeautifulSoup:
    """Return a page of a report after checking that its elements are all closed."""
    text = path.read_text(encoding="utf-8")
    for tag in set(re.findall(r"</(\w+)>", text)):
        begun = re.findall(rf"<{tag}(?:\s[^<>]*)?(?<!/)>", text)
        assert len(begun) == text.count(f"</{tag}>"), tag
    return BeautifulSoup(text, "html.parser")


def test_labels_replace_condition_names_everywhere_but_in_data(
    page: BeautifulSoup, folder: Path
) -> None:
    conditions = set(re.findall(r'"(xx_\w+)"', (folder / "results.json").read_text("utf-8")))
    assert len(conditions) > 1
    text = page.get_text(" ")
    assert [name for name in conditions if label_of(name) not in text] == []
    written = [file.read_text("utf-8") for file in sorted(folder.glob("tables/*.tex"))]
    assert re.findall(r"xx.\S+", " ".join([text, *written])) == []


def test_the_page_is_self_contained_and_allows_only_its_own_scripts(
    page: BeautifulSoup, folder: Path
) -> None:
    assert not page.find_all(["link", "iframe", "object"])
    for element in page.find_all(True):
        for name, value in element.attrs.items():
            if name in {"href", "xlink:href", "src", "action"}:
                assert re.match(r"#|data:image/|tables/[\w.-]+$", str(value)), f"{name}={value}"
            assert not name.startswith("on")
    assert "@import" not in " ".join(element.get_text() for element in page("style"))
    (policy,) = (str(meta["content"]) for meta in page.select("meta[http-equiv]"))
    assert "default-src 'none'" in policy
    assert re.search(r"script-src 'sha256-[\w+/=]+';", policy)
    assert not re.search(r"url\((?!#)", str(page))
    for name in {str(a["href"]) for a in page.find_all("a", class_="data")}:
        assert (folder / name).exists(), name


def test_ids_are_unique_and_references_resolve(page: BeautifulSoup) -> None:
    ids = [element["id"] for element in page.find_all(id=True)]
    assert len(ids) == len(set(ids))
    wanted = {e["href"][1:] for e in page.find_all(href=re.compile("^#"))}
    wanted |= {e["xlink:href"][1:] for e in page.select("[xlink\\:href]")}
    for name in ("aria-labelledby", "aria-describedby"):
        wanted |= {e[name] for e in page.select(f"[{name}]")}
    wanted |= set(re.findall(r"url\(#([^)]+)\)", str(page)))
    assert wanted <= set(ids)


def test_tables_and_figures_are_accessible_to_screen_readers(page: BeautifulSoup) -> None:
    assert page.select("html[lang=en]")
    assert {header["scope"] for header in page.find_all("th")} <= {"row", "col", "colgroup"}
    pictures = page.find_all("svg")
    assert pictures
    for picture in pictures:
        assert picture["role"] == "img"
        assert picture.find("title") or picture["aria-label"]
    for figure in page.find_all("figure"):
        (caption,) = figure.find_all("figcaption")
        assert len(caption.get_text()) > 30


def test_every_figure_is_also_a_file_and_every_named_table_latex(
    page: BeautifulSoup, folder: Path
) -> None:
    for ending in ("pdf", "png", "svg"):
        figures = list((folder / "figures").glob(f"*.{ending}"))
        assert len(figures) == len(page.select("svg:not(.narrow)"))
        assert all(file.stat().st_size > 1000 for file in figures)
    latex = list((folder / "tables").glob("*.tex"))
    assert latex
    for file in latex:
        assert r"\toprule" in file.read_text("utf-8")


def test_hostile_names_are_escaped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("analysis.report.page.FORMATS", {})
    table = pairwise_table((HOSTILE, "other"), effects=(1.0, 0.0), participants=4, segments=4)
    report = report_of(table, "pairwise", tmp_path)

    page = opened(write_report(report, subject_of(report, title=HOSTILE), tmp_path))

    (said,), (script,) = page.select(".answer"), page.find_all("script")
    assert HOSTILE.replace("_", " ") in said.get_text()
    assert "alert" not in script.get_text()


def test_sentences_for_the_paper_match_the_page(page: BeautifulSoup, folder: Path) -> None:
    shown = " ".join(page.get_text(" ").split())

    paragraphs = (folder / "paper.txt").read_text("utf-8").strip().split("\n\n")
    assert len(paragraphs) > 4
    sentences = [sentence for paragraph in paragraphs for sentence in paragraph.split(". ")]
    assert [text for text in sentences if " ".join(text.split()) not in shown] == []
    assert "Methods" not in paragraphs[0]
    assert any(text.startswith("Computed with Motion Jury") for text in paragraphs)
