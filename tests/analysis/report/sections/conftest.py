"""Results of made tables, computed once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pandas as pd
import pytest

from analysis.report.content import Section
from analysis.report.figures import style
from analysis.results.report import TableReport
from tests.analysis.report.sections.reading import SCALE
from tests.analysis.report.subjects import headline
from tests.analysis.results.made_tables import (
    mismatch_table,
    pairwise_table,
    ranking_table,
    rating_table,
    report_of,
)

Analyse = Callable[[str, pd.DataFrame], TableReport]


@pytest.fixture(scope="session")
def analyse(tmp_path_factory: pytest.TempPathFactory) -> Analyse:
    """Return an analysis of a table by its protocol."""
    folder: Path = tmp_path_factory.mktemp("tables")

    return lambda protocol, table: report_of(table, protocol, folder)


@pytest.fixture(scope="session")
def reports(analyse: Analyse) -> Mapping[str, TableReport]:
    """Return the results of a table of each protocol, and of comparisons with one condition."""
    pairs = pairwise_table(participants=6, segments=4)
    with_static = pairs[(pairs["left"] == "static") | (pairs["right"] == "static")]
    # The table names another condition before 'static'.
    first = with_static[(with_static["left"] == "ours") & (with_static["segment"] == "s3")]
    sets = (
        rating_table(participants=6, segments=4).assign(set="1"),
        rating_table(("truth", "late"), participants=6, segments=4, seed=2).assign(set="2"),
    )
    two_questions = pairwise_table(questions=("rhythm", "emotion"), participants=6, segments=4)
    return {
        "all pairs": analyse("pairwise", two_questions),
        "against one": analyse("pairwise", pd.concat([first, with_static.drop(first.index)])),
        "mismatch": analyse("mismatch", mismatch_table(participants=6, segments=4)),
        "rating": analyse("rating", pd.concat(sets)),
        "ranking": analyse("ranking", ranking_table(participants=6, segments=4)),
    }


@pytest.fixture(scope="session")
def sections(reports: Mapping[str, TableReport]) -> Mapping[str, tuple[Section, ...]]:
    """Return the sections of all of these, drawn once."""
    changes: dict[str, dict[str, object]] = {
        "all pairs": {"origin": "rehearsal"},
        "against one": {"reference": "static"},
        "rating": {"scale_labels": {"match": SCALE}},
    }
    with pytest.MonkeyPatch.context() as patch:
        # As `quick_fonts`, which holds for a module.
        patch.setitem(style.STYLE, "pdf.fonttype", 3)
        return {name: headline(found, **changes.get(name, {})) for name, found in reports.items()}
