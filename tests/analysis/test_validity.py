from __future__ import annotations

import numpy as np
import pytest

from analysis.validity import DESIGNS, Design, main, measure, simulate, true_win_share

AMUSE_SIZED = Design(participants=22, segments=24, effect=0.0, participant_sd=0.6, segment_sd=0.45)


def test_the_clustered_test_keeps_its_level_where_the_pooled_one_does_not():
    found = measure(AMUSE_SIZED, studies=400, seed=7)
    assert 0.92 <= found.coverage <= 0.975
    assert found.rejections <= 0.08
    assert found.pooled_rejections >= 0.2


@pytest.mark.parametrize("segments", [6, 8])
def test_small_studies_with_an_effect_still_cover_the_truth(segments):
    design = Design(
        participants=25, segments=segments, effect=0.6, participant_sd=0.6, segment_sd=0.45
    )
    assert 0.92 <= measure(design, studies=400, seed=3).coverage <= 0.985


def test_the_true_win_share_is_what_many_answers_tend_to():
    design = Design(participants=700, segments=700, effect=0.8, participant_sd=0.6, segment_sd=0.45)
    answers, _, _ = simulate(design, np.random.default_rng(1))
    assert np.mean((np.sign(answers) + 1) / 2) == pytest.approx(true_win_share(design), abs=0.01)
    assert true_win_share(AMUSE_SIZED) == pytest.approx(0.5)


def test_the_command_prints_one_line_per_design(capsys):
    main(studies=3)
    assert len(capsys.readouterr().out.splitlines()) == 1 + len(DESIGNS)
