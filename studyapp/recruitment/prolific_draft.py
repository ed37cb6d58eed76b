"""What is sent to Prolific when a study is made there."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any, Final

from motion.errors import InputError
from motion.segment import Segment
from studyapp.study.settings.study import Study

PLACEHOLDERS: Final = (
    "?PROLIFIC_PID={{%PROLIFIC_PID%}}&STUDY_ID={{%STUDY_ID%}}&SESSION_ID={{%SESSION_ID%}}"
)
"""What Prolific fills in for each participant."""

CODE_TYPES: Final = {
    "completed": ("COMPLETED",),
    "screened_out": ("FIXED_SCREENOUT", "OTHER"),
    "failed_attention": ("FAILED_ATTENTION_CHECK",),
}
"""What Prolific calls each of the study's codes; the screened out are paid, or not."""

RETURN_REASON: Final = "The study looks for other participants."

CENTS: Final = 100
MINUTES_PER_HOUR: Final = 60


def internal_name(study: Study) -> str:
    """Return the name by which the researcher's own study is found again.

    Two studies may have one name, but not one code.
    """
    drawn = hashlib.sha256(study.recruitment.prolific.completed.encode()).hexdigest()
    return f"motionjury {study.name} {drawn[:8]}"


def prolific_draft(study: Study, segments: Sequence[Segment], address: str) -> dict[str, Any]:
    """Return the draft of `study`, which participants reach at `address`.

    Raises
    ------
    InputError
        If the study file does not say what Prolific needs, or nobody could open the address.
    """
    _require(study, address)
    recruited = study.recruitment.prolific
    screened_out: list[dict[str, Any]] = [
        {"action": "REQUEST_RETURN", "return_reason": RETURN_REASON}
    ]
    if recruited.screened_out_reward:
        screened_out = [
            {
                "action": "FIXED_SCREEN_OUT_PAYMENT",
                "fixed_screen_out_reward": recruited.screened_out_reward,
                "slots": recruited.screened_out_places,
            }
        ]
    paid, unpaid = CODE_TYPES["screened_out"]
    finished = "AUTOMATICALLY_APPROVE" if recruited.automatic else "MANUALLY_REVIEW"
    phones = study.page.phones == "usable"
    heard = any(
        shown.speech is not None for content in study.contents(segments) for shown in content
    )
    draft: dict[str, Any] = {
        "name": study.title,
        "internal_name": internal_name(study),
        "description": recruited.description or study.title,
        "external_study_url": address + PLACEHOLDERS,
        "prolific_id_option": "url_parameters",
        "completion_codes": [
            _code(CODE_TYPES["completed"][0], recruited.completed, [{"action": finished}]),
            _code(
                paid if recruited.screened_out_reward else unpaid,
                recruited.screened_out,
                screened_out,
            ),
            _code(
                CODE_TYPES["failed_attention"][0],
                recruited.failed_attention,
                [{"action": "MANUALLY_REVIEW"}],
            ),
        ],
        "total_available_places": recruited.places or places_of(study),
        "estimated_completion_time": study.page.minutes,
        "reward": recruited.reward,
        "device_compatibility": ["desktop", *(("tablet", "mobile") if phones else ())],
        "peripheral_requirements": ["audio"] if heard else [],
        "filters": [],
    }
    if recruited.signed_for:
        draft["is_external_study_url_secure"] = True
    return draft | ({"project": recruited.project} if recruited.project else {})


def places_of(study: Study) -> int:
    """Return how many participants the study has places for."""
    return sum(arm.places for arm in study.arms)


def hourly(reward: float, minutes: int) -> float:
    """Return a reward in hundredths as whole units for an hour."""
    return reward / CENTS * MINUTES_PER_HOUR / minutes


def _code(kind: str, code: str, actions: list[dict[str, Any]]) -> dict[str, Any]:
    return {"code": code, "code_type": kind, "actor": "participant", "actions": actions}


def _require(study: Study, address: str) -> None:
    missing = [
        *(f"recruitment.prolific.{key}" for key in study.recruitment.missing_codes),
        *([] if study.recruitment.prolific.reward else ["recruitment.prolific.reward"]),
        *([] if study.page.minutes else ["page.minutes"]),
    ]
    if missing:
        raise InputError(
            f"Prolific needs {', '.join(missing)}",
            where="study.toml",
            remedy="Fill them in; 'motionjury recruit STUDY codes' draws the codes",
        )
    require_public(address)


def require_public(address: str) -> None:
    """Raise `InputError` unless `address` is one that recruiters accept."""
    if not address.startswith("https://") or "?" in address or "#" in address:
        raise InputError(
            "this is not an address that a recruiter accepts",
            where=address,
            remedy="Give the one at which the whole internet reaches the study, with https://",
        )
