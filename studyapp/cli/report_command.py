"""`motionjury report`, and an exclusion rule written in one word."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import click
from pydantic import TypeAdapter, ValidationError

from analysis.answers.participants import MAX_CATCH_FAILURES
from analysis.answers.table import LAYOUTS
from motion.errors import InputError
from studyapp.cli.arguments import optional_study_folder, refuse_beside, study_here
from studyapp.cli.output import sign_of_life
from studyapp.researchers.audit import read_reason
from studyapp.results.report import report, report_table
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.exclusions import EXCLUSION_SECTIONS, Exclusion, ExclusionSection
from studyapp.study.settings.sections import explain_errors


@click.command("report")
@optional_study_folder
@click.option(
    "--responses",
    type=click.Path(path_type=Path),
    help="Report a table of answers, CSV or Parquet, of any platform instead of a study; its "
    "columns are described in docs/report-contract.md.",
)
@click.option("--protocol", type=click.Choice(list(LAYOUTS)), help="How the table was answered.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="The folder that gets results.json, report.html and tables.",
)
@click.option(
    "--max-catch-failures",
    type=click.IntRange(0),
    metavar="N",
    help="Of a table: exclude who failed more than N catch trials.  "
    f"[default: {MAX_CATCH_FAILURES}]",
)
@click.option(
    "--margin",
    type=click.FloatRange(0, min_open=True),
    help="Of a table: the largest difference that does not matter, stated before the answers were "
    "seen; of a win share from one half (such as 0.05), of two mean ratings in scores. A study "
    "states its own as 'margin' in study.toml.",
)
@click.option(
    "--family",
    metavar="FAMILY",
    help="Of a table: which tests decide, and are corrected together: all (unless told otherwise), "
    "by question, against=CONDITION, primary=CONDITION,CONDITION[,QUESTION]. A study states its "
    "own as 'family' in study.toml.",
)
@click.option(
    "--scale",
    metavar="LOW-HIGH",
    help="Of a table of ratings: the lowest and the highest rating that could be given, such as "
    "1-5. Others are refused, and intervals end there.",
)
@click.option(
    "--exclude",
    "exclude",
    multiple=True,
    metavar="RULE",
    help="Of a table: leave out more participants, marked as exploratory: catch>N, attention>N, "
    "coverage<SHARE, time<SECONDS[,share=SHARE], straight_lining>=SHARE[,trials=N]. Can be "
    "repeated; the rules of a study stand in study.toml.",
)
@click.option(
    "--rehearsal",
    is_flag=True,
    help="Report the rehearsal's answers, though participants have answered.",
)
@click.option(
    "--with-motion",
    is_flag=True,
    help="Let readers of a study's report play the pairs that were preferred most and least, and "
    "turn the bodies around. The page stays one file, which gets 1 to 3 MB larger.",
)
@click.option(
    "--reason",
    help="Why you look at the results of a study; it stands in the study's log of looks and, "
    "where you look before the end, in later reports.",
)
def command(
    folder: StudyFolder | None,
    responses: Path | None,
    protocol: str | None,
    out: Path | None,
    max_catch_failures: int | None,
    margin: float | None,
    family: str | None,
    scale: str | None,
    exclude: tuple[str, ...],
    rehearsal: bool,
    with_motion: bool,
    reason: str | None,
) -> None:
    """Write the report of the study FOLDER: preferences and metrics, side by side.

    Or of a table of answers: --responses FILE --protocol NAME --out DIR.
    """
    of_table = {
        "--responses": responses,
        "--protocol": protocol,
        "--out": out,
        "--max-catch-failures": max_catch_failures,
        "--margin": margin,
        "--family": family,
        "--scale": scale,
        "--exclude": exclude or None,
    }
    if folder is None and all(value is None for value in of_table.values()):
        folder = study_here()
    if folder is not None:
        refuse_beside(of_table, "a study folder, which states all that itself")
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
        refuse_beside(
            {"--rehearsal": rehearsal, "--reason": reason, "--with-motion": with_motion},
            "a table, which has neither rehearsal nor log of looks nor motion",
        )
        if responses is None or protocol is None or out is None:
            raise _incomplete([name for name in _NEEDED if of_table[name] is None])
        page = report_table(
            responses,
            protocol,
            out,
            max_catch_failures=(
                MAX_CATCH_FAILURES if max_catch_failures is None else max_catch_failures
            ),
            margin=margin,
            family="all" if family is None else family,
            scale=None if scale is None else _scale(scale, protocol),
            exclude=[read_exclusion(text, where="--exclude").to_rule() for text in exclude],
        )
    click.echo(f"The report is {page}, the results are {page.with_name('results.json')}")


def _scale(text: str, protocol: str) -> tuple[int, int]:
    """Return the ends of a scale."""
    ends = re.fullmatch(r"(\d{1,4})-(\d{1,4})", text.strip())
    if ends is None or not int(ends[1]) < int(ends[2]) or protocol != "rating":
        raise InputError(
            f"{text!r} is not a scale of a {protocol} table",
            where="--scale",
            remedy="Of ratings, write the lowest and the highest, such as 1-5",
        )
    return int(ends[1]), int(ends[2])


_NEEDED = ("--responses", "--protocol", "--out")


def _incomplete(missing: Sequence[str]) -> InputError:
    nothing = len(missing) == len(_NEEDED)
    return InputError(
        "there is nothing to report"
        if nothing
        else f"{', '.join(missing)} is missing for the report of a table",
        remedy="Give a study folder, or a table with --responses FILE --protocol NAME --out DIR",
    )


_ADAPTER: Final[TypeAdapter[ExclusionSection]] = TypeAdapter(Exclusion)

_RULE: Final = re.compile(r"\s*(?P<name>[A-Za-z_-]+)\s*(?:(?P<sign>[<>]=?)\s*(?P<number>\S+))?\s*")

_SETTING: Final = re.compile(r"\s*(?P<key>[a-z_]+)\s*=\s*(?P<number>\S+)\s*")


def read_exclusion(text: str, *, where: object) -> ExclusionSection:
    """Return the rule that is written in one word.

    Parameters
    ----------
    text : str
        Such as ``coverage<0.9``, or with further settings ``time<3,share=0.25``; what
        `ExclusionSection.shorthand` returns.
    where : object
        What an error names.

    Raises
    ------
    InputError
        If there is no such rule, or it is not written like that.
    """
    word, *settings = text.split(",")
    head = _RULE.fullmatch(word)
    name = "" if head is None else head["name"].replace("-", "_")
    section = next((one for one in EXCLUSION_SECTIONS if _name(one) == name), None)
    if head is None or section is None:
        raise InputError(
            f"{text!r} is not an exclusion rule",
            where=where,
            remedy=f"Write one of {', '.join(map(_example, EXCLUSION_SECTIONS))}",
        )
    if head["sign"] != (section.limit[0] if section.limit else None):
        raise InputError(
            f"{text!r} is not how the rule {name!r} is written",
            where=where,
            remedy=f"Write {_example(section)}",
        )
    found: dict[str, object] = {"rule": name}
    if section.limit:
        found[section.limit[1]] = _number(head["number"])
    for setting in settings:
        parts = _SETTING.fullmatch(setting)
        if parts is None:
            raise InputError(
                f"{setting.strip()!r} in {text!r} is not KEY=NUMBER",
                where=where,
                remedy="Write further settings behind commas, such as time<3,share=0.25",
            )
        found[parts["key"]] = _number(parts["number"])
    try:
        return _ADAPTER.validate_python(found)
    except ValidationError as error:
        wrong = explain_errors(error).replace(f"{name}.", "")
        raise InputError(f"{text!r}: {wrong}", where=where, remedy="Correct the rule") from None


def _name(section: type[ExclusionSection]) -> str:
    return str(section.model_fields["rule"].default)


def _example(section: type[ExclusionSection]) -> str:
    return _name(section) + (f"{section.limit[0]}NUMBER" if section.limit else "")


def _number(text: str) -> object:
    """Return a number as TOML would read it, else the text, which the rule's key refuses."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
