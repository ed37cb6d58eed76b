"""`motionjury import`."""

from pathlib import Path
from typing import Any

import click

from motion.errors import InputError, counted
from motion.segment import EMOTIONS
from studyapp.cli.arguments import (
    EXISTING_FILE,
    FOLDER,
    Number,
    existing_study,
    file_rate_option,
    joints_option,
)
from studyapp.cli.output import echo_note, progress
from studyapp.stimuli.imported_folder import folder_items
from studyapp.stimuli.recordings import RecordingFacts, Take, import_clips, import_take
from studyapp.stimuli.video_takes import import_video
from studyapp.study.folder import StudyFolder


@click.command("import")
@click.argument("motion", nargs=-1, type=click.Path(exists=True, path_type=Path))
@click.argument("folder", type=FOLDER)
@click.option("--condition", help="The condition of the motion.")
@click.option(
    "--from-video",
    "video",
    type=EXISTING_FILE,
    help="Make takes for training in FOLDER from a video of a speaker.",
)
@click.option(
    "--speech",
    type=EXISTING_FILE,
    help="The speech of a new take, which adds its segments to the study.",
)
@file_rate_option
@click.option(
    "--segment",
    "segment_seconds",
    type=Number(0, 600, min_open=True),
    help="Cut the take into segments of this many seconds.",
)
@click.option("--speaker", help="The speaker of the take.")
@click.option("--emotion", type=click.Choice(EMOTIONS), help="The emotion of the take.")
@joints_option
@click.option(
    "--move",
    is_flag=True,
    help="With a folder: remove each file once it is imported; refused files stay.",
)
@click.option(
    "--as-recorded",
    is_flag=True,
    help="Leave the hands of a BVH where they are, even inside the body.",
)
def command(
    motion: tuple[Path, ...],
    folder: Path,
    video: Path | None,
    speech: Path | None,
    move: bool,
    **options: Any,
) -> None:
    """Import MOTION into the study FOLDER.

    With --speech, a motion file and its speech become new segments. Without it, each motion file
    must be named after an existing segment. MOTION can also be a folder of speech, motion and
    finished videos. With --from-video, FOLDER is not a study but a folder of takes for 'motionjury
    train'.
    """
    facts = RecordingFacts(**options)
    speaker, emotion = facts.speaker, facts.emotion
    if video is not None:
        if motion or move or speech is not None or facts != RecordingFacts(speaker=speaker):
            raise click.UsageError("--from-video can only be combined with FOLDER and --speaker.")
        _import_video(video, folder, speaker)
        return
    if len(motion) == 1 and motion[0].is_dir():
        if speech is not None:
            raise click.UsageError("The speech of a folder must be in the folder: omit --speech.")
        study = existing_study(folder)
        with study.locked():
            _import_folder(study, motion[0], facts, move=move)
        return
    if move or any(path.is_dir() for path in motion):
        raise click.UsageError("Give one folder, or files without --move.")
    condition = facts.condition
    if not motion or condition is None:
        raise click.UsageError("Give MOTION and --condition, or --from-video.")
    study = existing_study(folder)
    if speech is None:
        if any(given is not None for given in (facts.segment_seconds, speaker, emotion)):
            raise click.UsageError(
                "--segment, --speaker and --emotion describe --speech: give it too."
            )
        with study.locked():
            notes = import_clips(study, motion, condition, facts)
        imported = f"{counted(len(motion), 'clip')} of condition {condition!r}"
    else:
        if len(motion) != 1 or speaker is None or emotion is None:
            raise click.UsageError("--speech needs one motion file, --speaker and --emotion.")
        take = Take(**vars(facts), motion=motion[0], speech=speech)
        with study.locked():
            segments, notes = import_take(study, take)
        imported = f"{counted(len(segments), 'segment')} with condition {condition!r}"
    for note in notes:
        echo_note(note)
    click.echo(f"Imported {imported} into {folder}.")


def _import_folder(study: StudyFolder, source: Path, facts: RecordingFacts, *, move: bool) -> None:
    """Import one item after another; a refused item does not stop the others."""
    items, refused = folder_items(study, source, facts), 0
    with progress("import", "item") as show:
        for number, item in enumerate(items, start=1):
            try:
                notes = item.store()
            except InputError as error:
                refused += 1
                first, message = str(item.files[0]), str(error)
                where = "" if message.startswith(first) else f"{first}: "
                click.echo(f"refused: {where}{message}")
            else:
                for note in notes:
                    echo_note(note)
                if move:
                    for file in item.files:
                        file.unlink(missing_ok=True)
            show(number, len(items), item.files[0].name)
    imported = len(items) - refused
    click.echo(f"Imported {imported} of {len(items)} items into {study.root.resolve().name}.")
    if refused:
        raise InputError(
            f"{refused} of {len(items)} items could not be imported, and stay where they are",
            where=source,
            remedy="Correct or remove them, and run the command again",
        )


def _import_video(video: Path, folder: Path, speaker: str | None) -> None:
    with progress("detect", "frame") as show:
        takes = import_video(video, folder, speaker=speaker, on_frame=show)
    for note in takes.notes:
        echo_note(note)
    count = counted(len(takes.takes), "take")
    click.echo(f"{count} of {takes.seconds:.1f} s in {folder}. Next: 'motionjury train'.")
