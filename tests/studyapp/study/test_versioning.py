"""Settings that may change while a study runs, and which changes are logged."""

from typing import Any

import pytest

from studyapp.study.versioning import design_digest, operation_changes, operation_part
from tests.support.studies.made_study import CODES, make_segments, make_study

SEGMENTS = make_segments(["happiness", "anger"])
NETWORK = {"preset": "emage", "file": "AESKConv_240_100.bin"}
STATIC = {
    "rule_based": {},
    "mismatched": {},
    "static": {"generative": False, "label": "Nothing moves"},
}


@pytest.mark.parametrize(
    ("changes", "noted"),
    [
        ({"participants_per_comparison": 30}, ["participants_per_comparison: 25 -> 30"]),
        (
            {"page": {"consent": "You agree.", "devices": ["phone"]}},
            ["page.devices: ['computer', 'tablet'] -> ['phone']"],
        ),
        (
            {"recruitment": {"channel": "prolific", "prolific": CODES}},
            ["recruitment.channel: 'link' -> 'prolific'"],
        ),
        (
            {"exclusions": [{"rule": "catch", "more_than": 0}]},
            ["exclusions: ['incomplete', 'catch>1'] -> ['catch>0']"],
        ),
        ({"conditions": STATIC}, []),
        ({"evaluator": NETWORK}, []),
        ({"margin": 0.1}, []),
        ({"family": "by question"}, []),
        ({"rehearsal": {"careless": 0.5, "strength": {"static": 3}}}, []),
        ({"alarms": {"stalled_hours": 3}}, []),
    ],
)
def test_settings_invisible_to_participants_may_change_and_are_logged(
    changes: dict[str, Any], noted: list[str]
) -> None:
    before, after = make_study(), make_study(**changes)

    assert after != before
    assert design_digest(after, SEGMENTS, {}) == design_digest(before, SEGMENTS, {})
    assert list(operation_changes(operation_part(before), operation_part(after))) == noted


def test_a_key_known_to_only_one_release_is_not_a_change() -> None:
    present = operation_part(make_study())
    earlier = {key: value for key, value in present.items() if key != "exclusions"}

    assert operation_changes(earlier, present) == ()
