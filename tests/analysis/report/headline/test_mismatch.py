from __future__ import annotations

from collections.abc import Mapping

import pytest

from analysis.report.content import Section
from analysis.results.mismatch import MismatchResults
from analysis.results.report import TableReport
from tests.analysis.report.headline.reading import hints, named_picture, named_table, words


def test_own_speech_stands_on_the_left_of_every_condition(
    matched: TableReport, sections: Mapping[str, tuple[Section, ...]]
) -> None:
    assert isinstance(matched.results, MismatchResults)
    (section,) = sections["mismatch"]
    picture = named_picture(section, "own-speech")
    said = hints(picture)
    for one in matched.results.conditions:
        assert f"clearly own speech: {one.counts['own_strong']} of {one.n}" in " ".join(said)
    assert any(text.startswith("truth") for text in words(picture))
    table = named_table(section, "own-speech")
    best = {row[0].text: row[1].value for row in table.rows}
    assert best == pytest.approx({c.condition: c.share["own"] for c in matched.results.conditions})
