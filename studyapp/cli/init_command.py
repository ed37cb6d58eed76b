"""`motionjury init`."""

from __future__ import annotations

from pathlib import Path
from typing import cast, get_args

import click

from motion.files import write_text
from studyapp.study.condition_options import read_conditions
from studyapp.study.folder import StudyFolder
from studyapp.study.interview import MAX_MINUTES, MAX_PARTICIPANTS, read_pay, require_stated_pay
from studyapp.study.settings.presentation import Framing, Language
from studyapp.study.settings.recruitment import Channel
from studyapp.study.study_file import TEMPLATES, render_study_file, require_new_file
from studyapp.study.study_options import StudyOptions


@click.command("init")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@click.option("--template", type=click.Choice(TEMPLATES), default="pairwise", show_default=True)
@click.option(
    "--language",
    type=click.Choice(get_args(Language)),
    default="en",
    show_default=True,
    help="What participants read in.",
)
@click.option(
    "--condition",
    "conditions",
    multiple=True,
    metavar="NAME=SOURCE",
    help="A condition, in place of the template's; once for each. The source is 'files' (motion "
    "that is imported), 'videos' (finished ones), a generator such as 'rule_based', "
    "'mismatched:OTHER', or a network and its weights, 'NETWORK:FILE'.",
)
@click.option(
    "--reference",
    help="The condition every other one is compared with; of rankings, the one shown apart.",
)
@click.option(
    "--catch-videos",
    is_flag=True,
    help="Videos of a broken motion will be brought in videos/broken/ for catch trials.",
)
@click.option("--trials", type=click.IntRange(1, 500), help="Pairs each participant judges.")
@click.option(
    "--participants",
    type=click.IntRange(1, MAX_PARTICIPANTS),
    help="How many take part; of pairwise studies, in each comparison.",
)
@click.option(
    "--framing",
    type=click.Choice(get_args(Framing)),
    help="How much of the body the videos show. By default the face where all questions are about "
    "it, else the upper body.",
)
@click.option(
    "--recruit",
    "channel",
    type=click.Choice(get_args(Channel)),
    help="Where participants come from. For Prolific, codes are drawn.",
)
@click.option(
    "--pay",
    metavar="'AMOUNT CURRENCY'",
    help="What each participant gets, such as '2.50 GBP'. Mechanical Turk pays in USD.",
)
@click.option("--minutes", type=click.IntRange(1, MAX_MINUTES), help="How long it takes.")
@click.option("--title", help="What participants see as the study's title.")
@click.option("--organisation", help="Who runs the study.")
@click.option("--contact", help="Whom participants can ask.")
@click.option("--ethics", help="Who approved the study.")
def command(
    folder: Path,
    template: str,
    language: Language,
    conditions: tuple[str, ...],
    reference: str | None,
    catch_videos: bool,
    trials: int | None,
    participants: int | None,
    framing: Framing | None,
    channel: str | None,
    pay: str | None,
    minutes: int | None,
    title: str | None,
    organisation: str | None,
    contact: str | None,
    ethics: str | None,
) -> None:
    """Make a study FOLDER with a commented study.toml that can be edited.

    A study file that is there is never overwritten. 'motionjury desk' asks for all of it in the
    browser.

    Whatever else there is to say is said in study.toml, such as how a network samples.
    """
    study_folder = StudyFolder(folder)
    require_new_file(study_folder.definition)
    wanted = StudyOptions(
        name=folder.resolve().name,
        template=template,
        language=language,
        title=title,
        reference=reference,
        trials=trials,
        participants=participants,
        conditions=read_conditions(conditions, folder),
        catch_videos=catch_videos,
        framing=framing,
        channel=cast("Channel | None", channel),
        pay=None if pay is None else read_pay(pay, channel),
        minutes=minutes,
        organisation=organisation,
        contact=contact,
        ethics=ethics,
    )
    require_stated_pay(wanted)
    text = render_study_file(wanted, where=study_folder.definition)
    write_text(study_folder.definition, text)
    click.echo(f"{study_folder.definition} is ready. Next: {_next(text)}.")


def _next(text: str) -> str:
    """Return what comes after a new study."""
    if "videos = true" in (line.split("#")[0].strip() for line in text.splitlines()):
        return "put your videos into videos/CONDITION/SEGMENT.mp4, then run 'motionjury check'"
    return "'motionjury import' brings in speech"
