"""`motionjury generate`, with an option for each setting of a generator, and `corpus`."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Literal, get_args, get_origin

import click

from generators.registry import generator_names, settings_type
from generators.settings import File, Folder, types_of
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError, counted, listed
from motion.segment import EMOTIONS
from studyapp.cli.arguments import (
    EXISTING_FILE,
    FILE,
    FOLDER,
    Number,
    current_study,
    device_option,
    given_options,
    optional_study_folder,
    processes_option,
)
from studyapp.cli.output import progress
from studyapp.study.folder import StudyFolder
from studyapp.study.study_options import make_condition

_TYPES: Final = {
    File: FILE,
    Folder: FOLDER,
    int: click.INT,
    float: click.FLOAT,
    bool: click.BOOL,
}


class SettingsCommand(click.Command):
    """A command with an option for each setting of any generator, unless it has that itself."""

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the command's own options, those of generators, and --help."""
        *params, help_option = super().get_params(ctx)
        names = {param.name for param in params}
        settings = [option for option in _setting_options() if option.name not in names]
        return [*params, *settings, help_option]


def _setting_options() -> Iterator[click.Option]:
    """Yield an option for each setting; generators may share one."""
    types_by_name: dict[str, set[Any]] = {}
    takers_by_name: dict[str, dict[str, list[str]]] = {}
    for generator in generator_names():
        kind = settings_type(generator)
        for name, type_of_values in types_of(kind).items():
            description = kind.model_fields[name].description or ""
            types_by_name.setdefault(name, set()).add(type_of_values)
            takers_by_name.setdefault(name, {}).setdefault(description, []).append(generator)
    for name, types in types_by_name.items():
        takers = takers_by_name[name]
        yield click.Option(
            [f"--{name.replace('_', '-')}"],
            type=_param_type(types.pop()) if len(types) == 1 else click.STRING,
            help=" ".join(f"For {listed(names)}: {words}" for words, names in takers.items()),
        )


def _param_type(annotation: Any) -> click.ParamType[Any]:
    if get_origin(annotation) is Literal:
        return click.Choice(get_args(annotation))
    return _TYPES.get(annotation, click.STRING)


@click.command("generate", cls=SettingsCommand)
@optional_study_folder
@click.option("--generator", metavar=f"[{'|'.join(generator_names())}]", help="The generator.")
@click.option("--speech", type=EXISTING_FILE, multiple=True, help="A recording; can be repeated.")
@click.option("--out", type=FOLDER, help="The folder for the clips of --speech.")
@click.option(
    "--emotion",
    metavar=f"[{'|'.join(EMOTIONS)}]",
    help="The emotion of the speech, by default neutral. For amuse, also a recording that has it.",
)
@click.option("--seed", type=click.IntRange(0), default=1, help="Seed of the random numbers.")
@click.option(
    "--fps",
    type=Number(MIN_FRAME_RATE, MAX_FRAME_RATE),
    default=30.0,
    help="Frame rate of the clips of --speech.",
)
@device_option
def command(
    folder: StudyFolder | None,
    generator: str | None,
    speech: tuple[Path, ...],
    out: Path | None,
    emotion: str | None,
    seed: int,
    fps: float,
    device: str,
    **settings: Any,
) -> None:
    """Generate the motion of all generated conditions of the study FOLDER.

    With --generator, --speech and --out, generate motion for recordings without a study.
    """
    # Imported here: generators take a second to load, which --help should not wait for.
    from studyapp.stimuli.generation import generate, generate_files

    if folder is None and generator is None:
        folder = current_study()
    if folder is not None:
        if set(given_options()) - {"--device"}:
            raise InputError(
                "the generators of a study are set in its study.toml, and so is the seed",
                where=folder.definition,
                remedy="Leave these options out, or give no folder but --generator, --speech "
                "and --out",
            )
        with progress("generate", "clip") as show:
            count = generate(folder, device=device, on_clip=show)
    else:
        if generator is None or not speech or out is None:
            raise InputError(
                "give a study folder, or all of --generator, --speech and --out",
                remedy="Add what is missing",
            )
        if "emotion" in settings_type(generator).model_fields:
            settings["emotion"] = emotion
        elif emotion not in (None, *EMOTIONS):
            raise InputError(
                f"unknown emotion {emotion!r}", remedy=f"Use one of {', '.join(EMOTIONS)}"
            )
        condition = make_condition(generator, settings)
        with progress("generate", "clip") as show:
            count = generate_files(
                speech,
                out,
                generator=generator,
                settings=condition.settings.resolved_in(Path()),
                device=device,
                seed=seed,
                frame_rate=fps,
                emotion=emotion if emotion in EMOTIONS else "neutral",
                on_clip=show,
            )
    for remark in count.remarks:
        click.echo(remark, err=True)
    click.echo(f"Generated {counted(count.made, 'clip')}, kept {count.kept} up-to-date ones.")


@click.command("corpus")
@click.argument("folder", type=FOLDER)
@click.option(
    "--speakers",
    type=click.IntRange(1),
    default=8,
    help="Number of speakers, held-out ones included.",
)
@click.option(
    "--sentences",
    type=click.IntRange(8),
    default=16,
    help="Passages of each speaker, a multiple of eight: the same number in each emotion.",
)
@click.option("--takes", type=click.IntRange(1), default=2, help="Takes of each passage.")
@click.option(
    "--held-out-speakers",
    type=click.IntRange(0),
    default=2,
    help="Speakers, the last ones, that are kept out of training.",
)
@click.option(
    "--shared-passages",
    is_flag=True,
    help="Let all speakers speak the same passages, as a speech model such as AMUSE's needs.",
)
@click.option(
    "--fps",
    type=Number(MIN_FRAME_RATE, MAX_FRAME_RATE),
    default=30.0,
    help="Frames per second of the body; the face has 60, as in BEAT.",
)
@click.option("--seed", type=click.IntRange(0), default=1)
@processes_option
def corpus_command(folder: Path, fps: float, processes: int, **options: Any) -> None:
    """Make a synthetic corpus of speech and motion in FOLDER, laid out as BEAT.

    espeak-ng speaks passages in eight emotions; the motion follows speech, emotion and speaker by
    a process that docs/corpus.md states. Use it to train and evaluate networks without recordings;
    it says nothing about people.

    Run the same command again to continue an interrupted run. The same options give the same
    bytes.
    """
    # Imported here: signal processing takes a second to load, which --help should not wait for.
    from training.corpus.making import make_corpus
    from training.corpus.plan import CorpusRequest

    request = CorpusRequest(frame_rate=fps, **options)
    with progress("corpus", "take") as show:
        takes, new_takes = make_corpus(folder, request, processes=processes, show=show)
    kept = len(takes) - new_takes
    click.echo(
        f"Made {counted(new_takes, 'take')} in {folder}" + (f"; kept {kept}" if kept else "")
    )
    counts = {
        split: sum(take.split == split for take in takes)
        for split in ("train", "validation", "test")
    }
    click.echo(", ".join(f"{count} for {split}" for split, count in counts.items()))
