"""Results of made tables, computed once."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pandas as pd
import pytest

from analysis.report.content import Section
from analysis.results.report import TableReport
from tests.analysis.report.sections.reading import SCALE
from tests.analysis.report.subjects import headline
from tests.analysis.results.made_tables import TABLES, pairwise_table, rating_table, report_of

Analyse = Callable[[str, pd.DataFrame], TableReport]
Reports = Callable[[str], TableReport]
Sections = Callable[[str], tuple[Section, ...]]


@pytest.fixture(scope="session")
def analyse(tmp_path_factory: pytest.TempPathFactory) -> Analyse:
    """Return an analysis of a table by its protocol."""
    folder: Path = tmp_path_factory.mktemp("tables")

    return lambda protocol, table: report_of(table, protocol, folder)


@pytest.fixture(scope="session")
def reports(analyse: Analyse) -> Reports:
    """Return the results of a table of a protocol, or of comparisons with one condition."""

    @cache
    def report(name: str) -> TableReport:
        if name == "all pairs":
            pairs = pairwise_table(questions=("rhythm", "emotion"), participants=6, segments=4)
            return analyse("pairwise", pairs)
        if name == "against one":
            pairs = pairwise_table(participants=6, segments=4)
            with_static = pairs[(pairs["left"] == "static") | (pairs["right"] == "static")]
            # The table names another condition before 'static'.
            first = with_static[(with_static["left"] == "ours") & (with_static["segment"] == "s3")]
            return analyse("pairwise", pd.concat([first, with_static.drop(first.index)]))
        if name == "rating":
            other = rating_table(("truth", "late"), participants=6, segments=4, seed=2)
            sets = {"1": rating_table(participants=6, segments=4), "2": other}
            return analyse(name, pd.concat([sets[key].assign(set=key) for key in sets]))
        return analyse(name, TABLES[name](participants=6, segments=4))

    return report


@pytest.fixture(scope="session")
def sections(reports: Reports) -> Sections:
    """Return the sections of one of these, drawn once."""
    changes: dict[str, dict[str, object]] = {
        "all pairs": {"origin": "rehearsal"},
        "against one": {"reference": "static"},
        "rating": {"scale_labels": {"match": SCALE}},
    }
    return cache(lambda name: headline(reports(name), **changes.get(name, {})))
