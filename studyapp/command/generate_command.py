"""`motionjury generate`."""

from __future__ import annotations

from pathlib import Path

import click

from generators.model_settings import DATASETS, ModelSettings
from generators.registry import generator_names
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError
from motion.segment import EMOTIONS
from studyapp.command.arguments import optional_study_folder
from studyapp.command.progress import progress
from studyapp.definition.folder import StudyFolder
from studyapp.stages.generation import generate
from studyapp.stages.generation_of_files import FileMotion, generate_files

_file = click.Path(exists=True, dir_okay=False, path_type=Path)
_folder = click.Path(file_okay=False, path_type=Path)


@click.command("generate")
@optional_study_folder
@click.option("--generator", type=click.Choice(generator_names()), help="Move to --speech by it.")
@click.option("--speech", type=_file, multiple=True, help="A recording; may be repeated.")
@click.option("--out", type=_folder, help="Where the clips of --speech go.")
@click.option(
    "--checkpoint",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Weights of a learned generator.",
)
@click.option("--dataset", type=click.Choice(DATASETS), help="What they were trained on: beat.")
@click.option("--stats", type=_folder, help="Means and deviations of a released checkpoint.")
@click.option("--hubert", type=_folder, help="HuBERT's weights; without, a stand-in hears.")
@click.option("--speaker", type=click.IntRange(1), help="As which of its speakers it moves.")
@click.option("--emotion", type=click.Choice(EMOTIONS), default="neutral", help="Of the speech.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Chance.")
@click.option(
    "--fps",
    type=click.FloatRange(MIN_FRAME_RATE, MAX_FRAME_RATE),
    default=30.0,
    show_default=True,
    help="Frames per second of the clips of --speech.",
)
def command(
    folder: StudyFolder | None,
    generator: str | None,
    speech: tuple[Path, ...],
    out: Path | None,
    checkpoint: Path | None,
    dataset: str | None,
    stats: Path | None,
    hubert: Path | None,
    speaker: int | None,
    emotion: str,
    seed: int,
    fps: float,
) -> None:
    """Make the motion of every generated condition of the study FOLDER.

    Or, with --generator, --speech and --out, motion to recordings without any study.
    """
    of_model = {"--dataset": dataset, "--stats": stats, "--hubert": hubert, "--speaker": speaker}
    if folder is not None:
        if generator or speech or out or checkpoint or any(of_model.values()):
            raise InputError(
                "a study says itself how its conditions move",
                where=folder.definition,
                remedy="Set generator, checkpoint and the like there, or leave the folder out",
            )
        with progress("generate", "clip") as show:
            count = generate(folder, on_clip=show)
    else:
        if generator is None or not speech or out is None:
            raise InputError(
                "there is neither a study nor all of --generator, --speech and --out",
                remedy="Give a study folder, or the three options",
            )
        how = FileMotion(
            generator=generator,
            model=_model(checkpoint, dataset, stats, hubert, speaker),
            seed=seed,
            frame_rate=fps,
            emotion=emotion,
        )
        with progress("generate", "clip") as show:
            count = generate_files(speech, out, how, on_clip=show)
    for line in count.stand_ins:
        click.echo(f"Stands in for something real: {line}", err=True)
    click.echo(f"Generated {count.made} clips, kept {count.kept} that still fit.")


def _model(
    checkpoint: Path | None,
    dataset: str | None,
    stats: Path | None,
    hubert: Path | None,
    speaker: int | None,
) -> ModelSettings | None:
    if checkpoint is not None:
        return ModelSettings(
            checkpoint=checkpoint,
            dataset=dataset or "beat",
            stats=stats,
            hubert=hubert,
            speaker=speaker or 1,
        )
    if dataset or stats or hubert or speaker:
        raise InputError(
            "--dataset, --stats, --hubert and --speaker are of a learned generator",
            remedy="Give its --checkpoint, or leave them out",
        )
    return None
