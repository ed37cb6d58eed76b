from __future__ import annotations

import pytest

from analysis.preferences.segments import segment_shares
from analysis.responses import responses_frame


def test_each_segment_is_scored_on_its_own(answer):
    rows = [
        answer(study_session=session, segment=segment, position=place, value=value)
        for session, values in (("s1", (-2, 1)), ("s2", (0, 2)))
        for place, (segment, value) in enumerate(zip("ab", values, strict=True), start=1)
    ]
    found = {share.segment: share for share in segment_shares(responses_frame(rows))}
    assert found["a"].win_share == pytest.approx(0.75)
    assert found["b"].win_share == 0.0
    assert found["a"].answers == found["b"].answers == 2


def test_segments_add_up_to_their_emotion(simulated_study):
    responses = simulated_study(participants=6, segments=16).responses()
    main = responses[responses["kind"] == "main"]
    found = segment_shares(main)
    assert sum(share.answers for share in found) == len(main)
    assert len({(s.comparison, s.question, s.segment) for s in found}) == len(found)


def test_no_answers_are_no_segments():
    assert segment_shares(responses_frame([])) == ()
