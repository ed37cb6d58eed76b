"""What a reader of the results must know of a study's conditions."""

from __future__ import annotations

from studyapp.study.settings.study import Study


def study_notes(study: Study) -> tuple[str, ...]:
    """Return it, as sentences."""
    if study.has_recording or not study.catch.trials:
        return ()
    return (
        "No condition is a recording of a person, so there is no ground truth: "
        f"catch trials show {study.catch_against} against {study.catch.condition}.",
    )
