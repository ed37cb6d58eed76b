"""A study of three comparisons with three short trials each, for tests of bookkeeping."""

from functools import cache
from pathlib import Path
from typing import Final

from studyapp.session.served_study import ServedStudy
from studyapp.study.media import VideoFile
from tests.support.studies.made_study import make_segments, make_study

LEASE_MINUTES: Final = 45
PRESENTATIONS: Final = 3


@cache
def three_arms(places: int, *, withdrawn: str = "kept") -> ServedStudy:
    """Return a study of three arms with `places` places each.

    Its participants see two main trials and a catch trial and need not play anything; participants
    who fail the catch trial are replaced.
    """
    study = make_study(
        conditions={"rule_based": {}, "mismatched": {}, "static": {}, "noisy": {}},
        participants_per_comparison=places,
        lease_minutes=LEASE_MINUTES,
        replace_excluded=True,
        trials=2,
        practice=0,
        catch={"trials": 1, "condition": "broken", "generator": "broken", "max_failed": 0},
        watching={"coverage": 0},
    )
    segments = make_segments(["anger", "sadness"])
    return ServedStudy(
        study=study,
        definition=f'[page]\nwithdrawn = "{withdrawn}"\n',
        segments=segments,
        videos={
            content: VideoFile(file=Path("not-there.mp4"), duration=2.0, made_from="nothing")
            for content in study.contents(segments)
        },
    )
