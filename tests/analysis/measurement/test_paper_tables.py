from __future__ import annotations

from analysis.measurement.paper_tables import PAPER_TABLES
from analysis.measurement.presets import PRESETS


def test_every_table_is_of_a_preset():
    assert set(PAPER_TABLES) <= set(PRESETS)


def test_each_paper_calls_diversity_better_in_its_own_way():
    def of(preset):
        return [c.better for c in PAPER_TABLES[preset] if c.label == "Div"]

    assert of("amuse") == ["near the reference"]
    assert of("diffsheg") == ["higher", "higher"]


def test_no_table_shows_one_score_twice():
    for columns in PAPER_TABLES.values():
        assert len({column.metric for column in columns}) == len(columns)
