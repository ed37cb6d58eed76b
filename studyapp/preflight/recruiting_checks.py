"""What recruiters need, and whom the payment rule does not pay."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from motion.errors import InputError
from motion.listing import listed
from studyapp.preflight.finding import Finding, finding
from studyapp.recruitment.prolific_draft import CODE_TYPES, places_of
from studyapp.recruitment.record import FILE, read_made_there
from studyapp.study.settings.recruitment import FEWEST_FAILED_CHECKS, Recruitment
from studyapp.study.settings.study import Study


def code_findings(recruitment: Recruitment) -> Iterator[Finding]:
    """Say which of the study's codes do not do what codes are for."""
    for problem in recruitment.guessable_codes():
        key, _, why = problem.partition(": ")
        yield finding("code-guessable", why.partition(";")[0], where=key)
    for problem in recruitment.codes_alike():
        key, _, why = problem.partition(": ")
        yield finding("codes-alike", why, where=key)


def recruiting_findings(study: Study) -> Iterator[Finding]:
    """Say what is missing for the study's channel, and whom it does not pay."""
    recruitment = study.recruitment
    if recruitment.missing_codes:
        yield finding(
            "codes-missing",
            f"participants of Prolific have no code for {listed(recruitment.missing_codes)}",
            where="recruitment.prolific",
        )
    yield from _place_findings(study)
    limit, checks = recruitment.unpaid_failed_checks, study.attention.trials
    if recruitment.names_participants and limit and checks:
        if checks < limit:
            yield finding(
                "everybody-paid",
                f"everybody who finishes is paid: there are {checks} attention checks, and "
                f"{limit} must be failed",
                where="recruitment.unpaid_failed_checks",
                remedy=f"Set attention.trials to {max(limit, FEWEST_FAILED_CHECKS)} or more, if "
                "the rule is to matter",
            )
        else:
            yield finding(
                "unpaid-rule",
                f"who fails {limit} of {checks} attention checks need not be paid; everybody else "
                "who finishes is, whatever the exclusion rules say",
                where="recruitment.unpaid_failed_checks",
            )


def made_findings(study: Study, root: Path) -> Iterator[Finding]:
    """Say which codes Prolific does not know, where the study in `root` was made there."""
    try:
        there = read_made_there(root).prolific_codes
    except InputError as damaged:
        yield finding("made-there-unreadable", damaged.what, where=FILE)
        return
    codes = study.recruitment.prolific.model_dump()
    unknown = [key for key, types in CODE_TYPES.items() if there.get(codes[key]) not in types]
    if there and unknown and study.recruitment.channel == "prolific":
        yield finding(
            "codes-differ",
            f"Prolific does not know what study.toml has as the code for {listed(unknown)}",
            where="recruitment.prolific",
        )


def _place_findings(study: Study) -> Iterator[Finding]:
    recruitment, places = study.recruitment, places_of(study)
    told = {
        "prolific": ("recruitment.prolific.places", recruitment.prolific.places),
        "mturk": ("recruitment.mturk.assignments", recruitment.mturk.assignments),
    }
    key, recruited = told.get(recruitment.channel, ("", None))
    if recruited is not None and recruited != places:
        lost = "and find the study full" if recruited > places else "and leave places empty"
        yield finding(
            "places-differ",
            f"{recruited} participants are recruited for {places} places {lost}",
            where=key,
        )
