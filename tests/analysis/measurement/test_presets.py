from __future__ import annotations

import pytest

from analysis.evaluators import network_names
from analysis.measurement.presets import PRESETS, combined
from analysis.metrics.result import Better
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


def test_without_recordings_nothing_is_left_that_needs_them() -> None:
    alone = combined(PRESETS).without_recordings()
    assert alone.beats
    assert alone.derivatives
    assert not (alone.correct or alone.joint_errors or alone.velocity_errors)
    assert not alone.needs_rotations
    assert combined(["s2ue"]).needs_recorded_spread


def test_every_table_is_of_a_preset() -> None:
    assert set(PAPER_TABLES) <= set(PRESETS)


def test_each_paper_calls_diversity_better_in_its_own_way() -> None:
    def of(preset: str) -> list[Better]:
        return [c.better for c in PAPER_TABLES[preset] if c.label == "Div"]

    assert of("amuse") == ["near the reference"]
    assert of("diffsheg") == ["higher", "higher"]


def test_no_table_shows_one_score_twice_and_none_a_distance_that_no_network_gives() -> None:
    for columns in PAPER_TABLES.values():
        metrics = {column.metric for column in columns}
        assert len(metrics) == len(columns)
        distances = {name for name in metrics if name.startswith(("FGD", "FED", "FMD", "FLD"))}
        assert distances <= set(network_names.DISTANCES.values())
