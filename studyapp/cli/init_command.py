"""`motionjury init`."""

from pathlib import Path
from typing import Any, get_args

import click

from motion.errors import InputError
from studyapp.cli.arguments import FOLDER
from studyapp.study.folder import StudyFolder
from studyapp.study.interview import MAX_MINUTES, MAX_PARTICIPANTS, read_pay
from studyapp.study.settings.presentation import Language
from studyapp.study.settings.recruitment import Channel
from studyapp.study.study_file import TEMPLATES, write_study
from studyapp.study.study_options import StudyOptions, read_conditions


@click.command("init")
@click.argument("folder", type=FOLDER)
@click.option("--template", type=click.Choice(TEMPLATES), default="pairwise")
@click.option(
    "--language",
    type=click.Choice(get_args(Language)),
    default="en",
    help="The language of participants' pages.",
)
@click.option(
    "--condition",
    "conditions",
    multiple=True,
    metavar="NAME=SOURCE",
    help="A condition, replacing the template's; can be repeated. SOURCE is 'files' (imported "
    "motion), 'videos' (finished videos), a generator such as 'rule_based', 'mismatched:OTHER', or "
    "a network with its weights, 'NETWORK:FILE'.",
)
@click.option(
    "--reference",
    help="The condition that all others are compared with; in rankings, the one shown as the "
    "reference.",
)
@click.option(
    "--catch-videos",
    is_flag=True,
    help="You will put videos of a flawed motion into videos/broken/, for catch trials.",
)
@click.option("--trials", type=click.IntRange(1, 500), help="Pairs that each participant judges.")
@click.option(
    "--participants",
    type=click.IntRange(1, MAX_PARTICIPANTS),
    help="Number of participants; in pairwise studies, of each comparison.",
)
@click.option(
    "--recruit",
    "channel",
    type=click.Choice(get_args(Channel)),
    help="Where participants are recruited. For Prolific, completion codes are drawn.",
)
@click.option(
    "--pay",
    metavar="'AMOUNT CURRENCY'",
    help="Pay of each participant, such as '2.50 GBP'. Mechanical Turk pays in USD.",
)
@click.option("--minutes", type=click.IntRange(1, MAX_MINUTES), help="Duration of the study.")
@click.option("--title", help="The title that participants see.")
@click.option("--organisation", help="Who runs the study.")
@click.option("--contact", help="Whom participants can contact.")
@click.option("--ethics", help="Who approved the study.")
def command(
    folder: Path,
    conditions: tuple[str, ...],
    channel: Channel | None,
    pay: str | None,
    **options: Any,
) -> None:
    """Create a study FOLDER with a commented study.toml to edit.

    An existing study file is never overwritten. 'motionjury desk' does the same in the browser.

    All other settings, such as how a network samples, are made in study.toml.
    """
    study_folder = StudyFolder(folder)
    if study_folder.definition.exists():
        raise InputError(
            "the study already exists",
            where=study_folder.definition,
            remedy="Edit that file, or choose another folder",
        )
    study = StudyOptions(
        name=folder.resolve().name,
        conditions=read_conditions(conditions, folder),
        channel=channel,
        pay=None if pay is None else read_pay(pay),
        **options,
    )
    made = write_study(study_folder.definition, study)
    step = "import speech with 'motionjury import'"
    if any(condition.videos for condition in made.conditions.values()) or made.catch.videos:
        videos = "put your videos into videos/CONDITION/SEGMENT.mp4, then run 'motionjury check'"
        step = videos if made.only_finished else f"{step}, {videos}"
    click.echo(f"{study_folder.definition} is ready. Next: {step}.")
