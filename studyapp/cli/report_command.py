"""`motionjury report`, and the shorthand of exclusion rules."""

import re
from pathlib import Path
from typing import Any, Final

import click
from pydantic import ValidationError

from analysis.answers.participants import MAX_CATCH_FAILURES
from analysis.answers.table import LAYOUTS
from motion.errors import InputError
from studyapp.cli.arguments import (
    FOLDER,
    Number,
    current_study,
    given_options,
    optional_study_folder,
    refuse_options,
)
from studyapp.cli.output import sign_of_life
from studyapp.researchers.audit import read_reason
from studyapp.study.folder import StudyFolder, format_size
from studyapp.study.settings.exclusions import EXCLUSION_SECTIONS, ExclusionSection
from studyapp.study.settings.sections import explain_errors

_TABLE_OPTIONS: Final = (
    *("--responses", "--protocol", "--out"),
    *("--max-catch-failures", "--margin", "--family", "--scale", "--exclude"),
)


@click.command("report")
@optional_study_folder
@click.option(
    "--responses",
    type=click.Path(path_type=Path),
    help="Report a table of answers (CSV or Parquet) from any platform instead of a study; "
    "docs/report-contract.md describes its columns.",
)
@click.option("--protocol", type=click.Choice(list(LAYOUTS)), help="The protocol of the table.")
@click.option(
    "--out", type=FOLDER, help="The output folder, for results.json, report.html and tables."
)
@click.option(
    "--max-catch-failures",
    type=click.IntRange(0),
    default=MAX_CATCH_FAILURES,
    show_default=False,
    metavar="N",
    help="With a table: exclude participants who failed more than N catch trials.  "
    f"[default: {MAX_CATCH_FAILURES}]",
)
@click.option(
    "--margin",
    type=Number(0, min_open=True),
    help="With a table: the equivalence margin, chosen before the answers were seen; the largest "
    "irrelevant difference of a win share from one half (such as 0.05), or of two mean ratings. A "
    "study states it as 'margin' in study.toml.",
)
@click.option(
    "--family",
    default="all",
    show_default=False,
    metavar="FAMILY",
    help="With a table: the family of confirmatory tests, which are corrected together: all (the "
    "default), by question, against=CONDITION, primary=CONDITION,CONDITION[,QUESTION]. A study "
    "states it as 'family' in study.toml.",
)
@click.option(
    "--scale",
    metavar="LOW-HIGH",
    help="With a table of ratings: the lowest and highest possible rating, such as 1-5. Other "
    "ratings are refused, and intervals are clipped to it.",
)
@click.option(
    "--exclude",
    "rules",
    multiple=True,
    metavar="RULE",
    help="With a table: a further exclusion rule, marked as exploratory: catch>N, attention>N, "
    "coverage<SHARE, time<SECONDS[,share=SHARE], straight_lining>=SHARE[,trials=N]. Can be "
    "repeated; a study states its rules in study.toml.",
)
@click.option(
    "--rehearsal", is_flag=True, help="Report the rehearsal, even if participants have answered."
)
@click.option(
    "--with-motion",
    is_flag=True,
    help="Let readers of a study's report play the pairs that were preferred most and least, in "
    "three dimensions. The page stays one file, 1 to 3 MB larger.",
)
@click.option(
    "--reason",
    help="Why you look at the results of a study; it is stored in the study's log of looks and, "
    "before the end of the study, in later reports.",
)
def command(
    folder: StudyFolder | None,
    responses: Path | None,
    protocol: str | None,
    out: Path | None,
    scale: str | None,
    rules: tuple[str, ...],
    rehearsal: bool,
    with_motion: bool,
    reason: str | None,
    **tests: Any,
) -> None:
    """Write the report of the study FOLDER, with preferences and metrics side by side.

    Or report a table of answers: --responses FILE --protocol NAME --out DIR.
    """
    if folder is None and not set(given_options()) & {*_TABLE_OPTIONS}:
        folder = current_study()
    # Imported below: statistics take seconds to load, which --help should not wait for, and the
    # report of a table needs nothing of a study.
    if folder is not None:
        from studyapp.results.report import report

        refuse_options(_TABLE_OPTIONS, "a study folder, whose study.toml states all that")
        remarks: list[str] = []
        with sign_of_life("report") as show:
            page = report(
                folder,
                reason="" if reason is None else read_reason(reason),
                rehearsal=rehearsal,
                with_motion=with_motion,
                warn=remarks.append,
                on_step=show,
            )
        for remark in remarks:
            click.echo(remark)
    else:
        refuse_options(
            ("--rehearsal", "--reason", "--with-motion"),
            "a table, which has no rehearsal, no log of looks and no motion",
        )
        if responses is None or protocol is None or out is None:
            raise InputError(
                "there is nothing to report",
                remedy="Give a study folder, or a table with --responses FILE --protocol NAME "
                "--out DIR",
            )
        from analysis.report.page import report_table
        from analysis.results.report import analyse_table

        with sign_of_life("report") as show:
            show("comparing conditions")
            results = analyse_table(
                responses,
                protocol,
                scale=None if scale is None else _parse_scale(scale, protocol),
                exclude=[parse_exclusion(rule, where="--exclude").to_rule() for rule in rules],
                **tests,
            )
            show("drawing figures and tables")
            page = report_table(results, out)
    size = f" ({format_size(page.stat().st_size)})" if with_motion else ""
    click.echo(f"The report is {page}{size}, the results are {page.with_name('results.json')}")


def _parse_scale(text: str, protocol: str) -> tuple[int, int]:
    ends = re.fullmatch(r"(\d{1,4})-(\d{1,4})", text.strip())
    if ends is None or not int(ends[1]) < int(ends[2]) or protocol != "rating":
        raise InputError(
            f"{text!r} is not a scale of a {protocol} table",
            where="--scale",
            remedy="For ratings, write the lowest and the highest, such as 1-5",
        )
    return int(ends[1]), int(ends[2])


_RULE: Final = re.compile(
    r"(?P<rule>[a-z_]+)((?P<sign>[<>]=?)(?P<number>[^,]+))?(?P<settings>(,[a-z_]+=[^,]+)*)"
)


def parse_exclusion(text: str, *, where: object) -> ExclusionSection:
    """Return the rule of a shorthand.

    Parameters
    ----------
    text : str
        Such as ``coverage<0.9``, or with further settings ``time<3,share=0.25``; see
        `ExclusionSection.shorthand`.
    where : object
        The source of `text`, for errors.

    Raises
    ------
    InputError
        If there is no such rule, or it is written in another way.
    """
    parts = _RULE.fullmatch("".join(text.split()))
    section = None if parts is None else EXCLUSION_SECTIONS.get(parts["rule"])
    sign, key = (None, "") if section is None else section.limit or (None, "")
    if parts is None or section is None or parts["sign"] != sign:
        forms = (
            name + (f"{rule.limit[0]}NUMBER" if rule.limit else "")
            for name, rule in EXCLUSION_SECTIONS.items()
        )
        raise InputError(
            f"{text!r} is not an exclusion rule",
            where=where,
            remedy=f"Write one of {', '.join(forms)}; settings follow, such as time<3,share=0.25",
        )
    settings = dict(each.split("=") for each in parts["settings"].split(",")[1:])
    limit = {key: parts["number"]} if key else {}
    try:
        return section.model_validate_strings(limit | settings, strict=False)
    except ValidationError as error:
        problem = explain_errors(error)
        raise InputError(f"{text!r}: {problem}", where=where, remedy="Correct the rule") from None
