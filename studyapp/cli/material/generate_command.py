"""`motionjury generate`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import click

from generators.registry import generator_names, settings_type
from generators.trainable import Device
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError
from motion.segment import EMOTIONS
from studyapp.cli.arguments import optional_study_folder
from studyapp.cli.material.setting_options import SettingsCommand, condition_of
from studyapp.cli.progress import progress
from studyapp.stimuli.generation import generate
from studyapp.stimuli.generation_of_files import FileMotion, generate_files
from studyapp.study.folder import StudyFolder

_file = click.Path(exists=True, dir_okay=False, path_type=Path)
_folder = click.Path(file_okay=False, path_type=Path)


@click.command("generate", cls=SettingsCommand)
@optional_study_folder
@click.option(
    "--generator", metavar=f"[{'|'.join(generator_names())}]", help="Move to --speech by it."
)
@click.option("--speech", type=_file, multiple=True, help="A recording; may be repeated.")
@click.option("--out", type=_folder, help="Where the clips of --speech go.")
@click.option(
    "--emotion",
    metavar=f"[{'|'.join(EMOTIONS)}]",
    help="Of the speech: neutral. A recording, where the generator hears emotions.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Chance.")
@click.option(
    "--fps",
    type=click.FloatRange(MIN_FRAME_RATE, MAX_FRAME_RATE),
    default=30.0,
    show_default=True,
    help="Frames per second of the clips of --speech.",
)
@click.option(
    "--device",
    type=click.Choice(get_args(Device)),
    default="cpu",
    show_default=True,
    help="Where networks run.",
)
def command(
    folder: StudyFolder | None,
    generator: str | None,
    speech: tuple[Path, ...],
    out: Path | None,
    emotion: str | None,
    seed: int,
    fps: float,
    device: str,
    **given: Any,
) -> None:
    """Make the motion of every generated condition of the study FOLDER.

    Or, with --generator, --speech and --out, motion to recordings without any study.
    """
    if folder is not None:
        if generator or speech or out or any(value is not None for value in given.values()):
            raise InputError(
                "a study says itself how its conditions move",
                where=folder.definition,
                remedy="Set generator, checkpoint and the like there, or leave the folder out",
            )
        with progress("generate", "clip") as show:
            count = generate(folder, device=device, on_clip=show)
    else:
        if generator is None or not speech or out is None:
            raise InputError(
                "there is neither a study nor all of --generator, --speech and --out",
                remedy="Give a study folder, or the three options",
            )
        if "emotion" in settings_type(generator).model_fields:
            given["emotion"] = emotion
        elif emotion not in (None, *EMOTIONS):
            raise InputError(
                f"there is no emotion {emotion!r}", remedy=f"Use one of {', '.join(EMOTIONS)}"
            )
        condition = condition_of(generator, given)
        how = FileMotion(
            generator=generator,
            settings=condition.settings.within(Path()),
            device=device,
            seed=seed,
            frame_rate=fps,
            emotion=emotion if emotion in EMOTIONS else "neutral",
        )
        with progress("generate", "clip") as show:
            count = generate_files(speech, out, how, on_clip=show)
    for remark in count.remarks:
        click.echo(remark, err=True)
    click.echo(f"Generated {count.made} clips, kept {count.kept} that still fit.")
