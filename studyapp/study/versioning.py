"""Which keys of a study may change while it runs, and a digest of those that may not."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any, Final

from motion.segment import Segment
from studyapp.study.design.trial import Content
from studyapp.study.media import VideoFile
from studyapp.study.settings.study import Study

OPERATION: Final[dict[str, Any]] = {
    "name": True,
    "open": True,
    "lease_minutes": True,
    "participants": True,
    "participants_per_comparison": True,
    "page": {"organisation", "contact", "minutes", "payment", "ethics", "devices"},
    "watching": {"megabytes_per_page"},
    "recruitment": {"channel", "unpaid_failed_checks"},
}
"""Keys that may change while the study runs; changes are logged."""

RECRUITERS: Final[dict[str, Any]] = {"recruitment": True}
"""Keys that may change and are never logged: completion codes are among them."""

UNTRACKED: Final[dict[str, Any]] = {"rehearsal": True, "alarms": True}
"""Keys about rehearsals and alarms, which participants never notice."""

ANALYSIS: Final[dict[str, Any]] = {
    "exclusions": True,
    "evaluator": True,
    "margin": True,
    "family": True,
    "conditions": {"__all__": {"generative", "label"}},
}
"""Keys about the analysis. They may change too, but the report says so. All other keys are the
study's design."""


def operation_part(study: Study) -> dict[str, Any]:
    """Return what may change while `study` runs, as plain data."""
    rules = [rule.shorthand() for rule in study.settled_exclusions]
    return study.model_dump(mode="json", include=OPERATION) | {"exclusions": rules}


def operation_changes(before: dict[str, Any], after: dict[str, Any]) -> tuple[str, ...]:
    """Return what differs between two operation parts, as ``key: before -> after``.

    A key that only one of them has comes with a release of this program and is no change.
    """
    old, new = _flatten(before), _flatten(after)
    return tuple(
        f"{key}: {old[key]!r} -> {new[key]!r}"
        for key in sorted(old.keys() & new.keys())
        if old[key] != new[key]
    )


def changeable_keys() -> tuple[str, ...]:
    """Return the keys that may change while people take part, without those of conditions."""
    return tuple(
        f"{key}.{inner_key}" if isinstance(inner, set) else key
        for key, inner in (OPERATION | ANALYSIS | RECRUITERS | UNTRACKED).items()
        if key != "conditions"
        for inner_key in (sorted(inner) if isinstance(inner, set) else [""])
    )


def design_changes(before: Study, after: Study) -> tuple[str, ...]:
    """Return the keys in which the designs of two studies differ."""
    if before.protocol != after.protocol:
        return ("protocol",)
    old, new = _design(before), _design(after)
    return tuple(key for key in old | new if old.get(key) != new.get(key))


def design_digest(
    study: Study, segments: Sequence[Segment], videos: Mapping[Content, VideoFile]
) -> str:
    """Return a digest of everything that decides what participants see and are asked.

    Parameters
    ----------
    videos : mapping of Content to VideoFile
        The videos that show the study's contents.
    """
    speech = [[s.name, s.wav, s.start, s.end, s.speaker, s.emotion] for s in segments]
    shown = sorted(
        [*([s.condition, s.segment, s.speech or ""] for s in content), [videos[content].made_from]]
        for content in study.contents(segments)
        if content in videos
    )
    state = json.dumps([study.protocol, _design(study), speech, shown])
    return hashlib.sha256(state.encode()).hexdigest()


def _design(study: Study) -> dict[str, Any]:
    """Return the keys that decide what participants see and are asked, as plain data."""
    # Defaults do not count: writing one down, or a release with more keys, changes no design.
    keys = study.model_dump(
        mode="json", exclude=OPERATION | ANALYSIS | RECRUITERS | UNTRACKED, exclude_defaults=True
    )
    return {key: value for key, value in keys.items() if value != {}}


def _flatten(part: dict[str, Any]) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in part.items():
        if isinstance(value, dict):
            flat |= {f"{key}.{inner_key}": inner for inner_key, inner in value.items()}
        else:
            flat[key] = value
    return flat
