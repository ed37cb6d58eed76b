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
def all_pairs(analyse: Analyse) -> TableReport:
    """Return every pair of three conditions on two questions."""
    return analyse(
        "pairwise", pairwise_table(questions=("rhythm", "emotion"), participants=6, segments=4)
    )


@pytest.fixture(scope="session")
def against_one(analyse: Analyse) -> TableReport:
    """Return comparisons of 'static' with others, one of which the table names before it."""
    table = pairwise_table(participants=6, segments=4)
    shown = table[(table["left"] == "static") | (table["right"] == "static")]
    first = shown[(shown["left"] == "ours") & (shown["segment"] == "s3")]
    return analyse("pairwise", pd.concat([first, shown.drop(first.index)]))


@pytest.fixture(scope="session")
def matched(analyse: Analyse) -> TableReport:
    """Return mismatch trials of two conditions."""
    return analyse("mismatch", mismatch_table(participants=6, segments=4))


@pytest.fixture(scope="session")
def rated(analyse: Analyse) -> TableReport:
    """Return ratings of two sets with different conditions."""
    first = rating_table(participants=6, segments=4).assign(set="1")
    second = rating_table(("truth", "late"), participants=6, segments=4, seed=2).assign(set="2")
    return analyse("rating", pd.concat([first, second]))


@pytest.fixture(scope="session")
def ranked(analyse: Analyse) -> TableReport:
    """Return rankings of three conditions."""
    return analyse("ranking", ranking_table(participants=6, segments=4))


@pytest.fixture(scope="session")
def sections(
    all_pairs: TableReport,
    against_one: TableReport,
    matched: TableReport,
    rated: TableReport,
    ranked: TableReport,
) -> Mapping[str, tuple[Section, ...]]:
    """Return the sections of all of these, drawn once."""
    with pytest.MonkeyPatch.context() as patch:
        # As `quick_fonts`, which holds for a module.
        patch.setitem(style.STYLE, "pdf.fonttype", 3)
        return {
            "all pairs": headline(all_pairs, origin="rehearsal"),
            "against one": headline(against_one, reference="static"),
            "mismatch": headline(matched),
            "rating": headline(rated, scale_labels={"match": SCALE}),
            "ranking": headline(ranked),
        }
