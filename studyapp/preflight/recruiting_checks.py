"""What recruiters need, and whom the payment rule does not pay."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.listing import listed
from studyapp.preflight.finding import Finding, error, note, warning
from studyapp.recruitment.prolific_draft import CODE_TYPES, places_of
from studyapp.recruitment.record import FILE, read_made_there
from studyapp.study.settings.recruitment import FEWEST_FAILED_CHECKS, Recruitment
from studyapp.study.settings.study import Study

CODES_MISSING: Final = error(
    "codes-missing",
    "participants of Prolific have no code to leave with",
    "Draw the codes with 'motionjury recruit STUDY codes'",
)
CODE_GUESSABLE: Final = error(
    "code-guessable",
    "a completion code could be guessed, and whoever guesses it is paid",
    "Draw the codes with 'motionjury recruit STUDY codes'",
)
CODES_ALIKE: Final = error(
    "codes-alike",
    "two of Prolific's three codes are the same, so that it cannot be told who finished",
    "Draw the codes with 'motionjury recruit STUDY codes'",
)
CODES_DIFFER: Final = error(
    "codes-differ",
    "Prolific was told other codes than study.toml has, and pays nobody who comes back with these",
    "Write the codes that recruitment.json has noted back into study.toml",
)
MADE_THERE_UNREADABLE: Final = error(
    "made-there-unreadable",
    "recruitment.json is damaged, so that nobody knows what was made at recruiters' sites",
    "Bring it back from a backup",
)
PLACES_DIFFER: Final = warning(
    "places-differ",
    "the recruiting site is told another number of places than the study has",
    "Leave the number out in study.toml, so that it is the study's own",
)
EVERYBODY_PAID: Final = note(
    "everybody-paid",
    "there are fewer attention checks than must be failed, so that everybody who finishes is paid",
    "Set more attention.trials if the rule is to matter",
)
UNPAID_RULE: Final = note("unpaid-rule", "who need not be paid")


def code_findings(recruitment: Recruitment) -> Iterator[Finding]:
    """Say which of the study's codes do not do what codes are for."""
    for problem in recruitment.guessable_codes():
        key, _, why = problem.partition(": ")
        yield CODE_GUESSABLE.found(why.partition(";")[0], where=key)
    for problem in recruitment.codes_alike():
        key, _, why = problem.partition(": ")
        yield CODES_ALIKE.found(why, where=key)


def recruiting_findings(study: Study) -> Iterator[Finding]:
    """Say what is missing for the study's channel, and whom it does not pay."""
    recruitment = study.recruitment
    if recruitment.missing_codes:
        yield CODES_MISSING.found(
            f"participants of Prolific have no code for {listed(recruitment.missing_codes)}",
            where="recruitment.prolific",
        )
    yield from _place_findings(study)
    limit, checks = recruitment.unpaid_failed_checks, study.attention.trials
    if recruitment.names_participants and limit and checks:
        if checks < limit:
            yield EVERYBODY_PAID.found(
                f"everybody who finishes is paid: there are {checks} attention checks, and "
                f"{limit} must be failed",
                where="recruitment.unpaid_failed_checks",
                remedy=f"Set attention.trials to {max(limit, FEWEST_FAILED_CHECKS)} or more, if "
                "the rule is to matter",
            )
        else:
            yield UNPAID_RULE.found(
                f"who fails {limit} of {checks} attention checks need not be paid; everybody else "
                "who finishes is, whatever the exclusion rules say",
                where="recruitment.unpaid_failed_checks",
            )


def made_findings(study: Study, root: Path) -> Iterator[Finding]:
    """Say which codes Prolific does not know, where the study in `root` was made there."""
    try:
        there = read_made_there(root).prolific_codes
    except InputError as damaged:
        yield MADE_THERE_UNREADABLE.found(damaged.what, where=FILE)
        return
    codes = study.recruitment.prolific.model_dump()
    unknown = [key for key, types in CODE_TYPES.items() if there.get(codes[key]) not in types]
    if there and unknown and study.recruitment.channel == "prolific":
        yield CODES_DIFFER.found(
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
        yield PLACES_DIFFER.found(
            f"{recruited} participants are recruited for {places} places {lost}", where=key
        )
