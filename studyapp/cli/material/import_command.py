"""`motionjury import`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.formats.joint_maps import JointMap
from motion.segment import EMOTIONS
from studyapp.cli.arguments import existing_study, joints_option
from studyapp.cli.output import progress
from studyapp.stimuli.recordings import Take, import_clips, import_take
from studyapp.stimuli.video_takes import import_video

_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command("import")
@click.argument("motion", nargs=-1, type=_FILE)
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--condition", help="The condition this motion belongs to.")
@click.option(
    "--from-video",
    "video",
    type=_FILE,
    help="Make FOLDER, or add to it, takes for training from a video of somebody who talks.",
)
@click.option("--speech", type=_FILE, help="The take's speech; its segments are new to the study.")
@click.option("--fps", type=click.FloatRange(0, 1000, min_open=True), help="True frame rate.")
@click.option(
    "--segment",
    "segment_seconds",
    type=click.FloatRange(0, 600, min_open=True),
    help="Cut the take into segments of so many seconds.",
)
@click.option("--speaker", help="Who speaks.")
@click.option("--emotion", type=click.Choice(EMOTIONS), help="The emotion of the take.")
@joints_option
@click.option(
    "--as-recorded",
    is_flag=True,
    help="Leave hands of a BVH where another body had them, even inside trunk or thighs.",
)
def command(
    motion: tuple[Path, ...],
    folder: Path,
    condition: str | None,
    video: Path | None,
    speech: Path | None,
    fps: float | None,
    segment_seconds: float | None,
    speaker: str | None,
    emotion: str | None,
    joint_map: JointMap | None,
    as_recorded: bool,
) -> None:
    """Bring MOTION into the study FOLDER.

    With --speech, one motion file and its recording become new segments. Without it, each
    motion file must be named after a segment that the study has. With --from-video, FOLDER is not a
    study but a folder of takes, which 'motionjury train' reads.
    """
    if video is not None:
        others = (condition, speech, fps, segment_seconds, emotion, joint_map)
        if motion or as_recorded or any(option is not None for option in others):
            raise click.UsageError("--from-video goes with FOLDER and --speaker alone.")
        _import_video(video, folder, speaker)
        return
    if not motion or condition is None:
        raise click.UsageError("Give MOTION and --condition, or --from-video.")
    study = existing_study(folder)
    if speech is None:
        if segment_seconds is not None or speaker is not None or emotion is not None:
            raise click.UsageError("--segment, --speaker and --emotion describe --speech: give it.")
        notes = import_clips(
            study,
            motion,
            condition=condition,
            frame_rate=fps,
            as_recorded=as_recorded,
            joint_map=joint_map,
        )
        done = f"{len(motion)} clips of condition {condition!r}"
    else:
        if len(motion) != 1 or speaker is None or emotion is None:
            raise click.UsageError("--speech goes with one motion file, --speaker and --emotion.")
        take = Take(
            motion=motion[0],
            speech=speech,
            frame_rate=fps,
            segment_seconds=segment_seconds,
            condition=condition,
            speaker=speaker,
            emotion=emotion,
            as_recorded=as_recorded,
            joint_map=joint_map,
        )
        segments, notes = import_take(study, take)
        done = f"{len(segments)} segments with condition {condition!r}"
    for note in notes:
        click.echo(f"note: {note}")
    click.echo(f"Imported {done} into {folder}.")


def _import_video(video: Path, folder: Path, speaker: str | None) -> None:
    with progress("looking for somebody", "frame") as told:
        made = import_video(video, folder, speaker=speaker, told=told)
    for note in made.notes:
        click.echo(f"note: {note}")
    takes = "1 take" if len(made.takes) == 1 else f"{len(made.takes)} takes"
    click.echo(f"{takes} of {made.seconds:.1f} s in {folder}. Next: 'motionjury train'.")
