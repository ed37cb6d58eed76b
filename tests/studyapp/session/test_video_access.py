from __future__ import annotations

from studyapp.session.video_access import content_of
from tests.support.studies.taking_part_steps import Participant


def test_only_the_present_and_the_following_video_are_given_out(
    participant: Participant,
) -> None:
    first = participant.trial()
    assert content_of(participant.database, first.videos[0].token) is not None
    assert content_of(participant.database, first.next_videos[0]) is not None

    participant.take_trial()
    second = participant.trial()
    assert content_of(participant.database, first.videos[0].token) is None
    assert content_of(participant.database, second.videos[0].token) is not None

    participant.withdraw()
    assert content_of(participant.database, second.videos[0].token) is None
