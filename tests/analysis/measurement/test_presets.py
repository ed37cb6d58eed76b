from __future__ import annotations

import pytest

from analysis.evaluators import network_names
from analysis.measurement.presets import PRESETS, combined
from analysis.report.sections.metrics import PAPER_TABLES
from motion.errors import InputError


def test_what_two_presets_share_is_measured_once() -> None:
    together = combined(["beat", "diffsheg", "beat"])
    assert together.beats == PRESETS["beat"].beats == PRESETS["diffsheg"].beats
    assert [settings.name for settings in together.correct] == ["beat", "diffsheg"]
    assert together.mean_pose_deviation
    assert together.pair_distance
    assert not together.foot_sliding


def test_an_unknown_preset_is_refused_with_those_there_are() -> None:
    with pytest.raises(InputError, match=r"'amuze'.*amuse, beat"):
        combined(["amuze"])


def test_a_papers_table_is_of_a_preset_and_shows_each_score_once() -> None:
    distances = set(network_names.DISTANCES.values())
    for preset, columns in PAPER_TABLES.items():
        assert preset in PRESETS
        metrics = {column.metric for column in columns}
        assert len(metrics) == len(columns)
        assert {name for name in metrics if name.startswith(("FGD", "FED", "FMD"))} <= distances
