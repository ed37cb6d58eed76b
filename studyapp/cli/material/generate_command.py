"""`motionjury generate`, and options for what generators take besides speech."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Literal, get_args, get_origin

import click

from generators.registry import Device, generator_names, settings_type
from generators.settings import File, Folder, Setting, settings_of
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError
from motion.segment import EMOTIONS
from studyapp.cli.arguments import optional_study_folder
from studyapp.cli.output import counted, progress
from studyapp.study.condition_options import make_condition
from studyapp.study.folder import StudyFolder

_TYPES: Final = {
    File: click.Path(dir_okay=False, path_type=Path),
    Folder: click.Path(file_okay=False, path_type=Path),
    int: click.INT,
    float: click.FLOAT,
    bool: click.BOOL,
}


class SettingsCommand(click.Command):
    """A command that has an option for each setting of any generator, but where it has its own."""

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the command's own options, those of generators, and --help."""
        *own, last = super().get_params(ctx)
        taken = {param.name for param in own}
        return [*own, *(option for option in _options() if option.name not in taken), last]


def _options() -> Iterator[click.Option]:
    """Yield an option for each setting of any generator, those that several have once."""
    found: dict[str, dict[str, Setting]] = {}
    for generator in generator_names():
        for setting in settings_of(settings_type(generator)):
            found.setdefault(setting.key, {})[generator] = setting
    for name, takers in found.items():
        types = {setting.type for setting in takers.values()}
        meanings = {generator: setting.description for generator, setting in takers.items()}
        same = len(set(meanings.values())) == 1
        yield click.Option(
            [f"--{name.replace('_', '-')}"],
            type=_type(types.pop()) if len(types) == 1 else click.STRING,
            help=" ".join(
                dict.fromkeys(
                    meaning if same else f"Of {generator}: {meaning}"
                    for generator, meaning in meanings.items()
                )
            ),
        )


def _type(kind: Any) -> click.ParamType[Any]:
    if get_origin(kind) is Literal:
        return click.Choice(get_args(kind))
    return _TYPES.get(kind, click.STRING)


_file = click.Path(exists=True, dir_okay=False, path_type=Path)
_folder = click.Path(file_okay=False, path_type=Path)


@click.command("generate", cls=SettingsCommand)
@optional_study_folder
@click.option(
    "--generator", metavar=f"[{'|'.join(generator_names())}]", help="What makes the motion."
)
@click.option("--speech", type=_file, multiple=True, help="A recording; may be repeated.")
@click.option("--out", type=_folder, help="Where the clips of --speech go.")
@click.option(
    "--emotion",
    metavar=f"[{'|'.join(EMOTIONS)}]",
    help="The speech's emotion: neutral. For amuse, also a recording to take it from.",
)
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=1,
    show_default=True,
    help="Another seed, other motion.",
)
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
    # Imported here: what moves bodies takes a second to load, which --help need not wait for.
    from studyapp.stimuli.generation import generate, generate_files

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
        condition = make_condition(generator, given)
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
    click.echo(f"Generated {counted(count.made, 'clip')}, kept {count.kept} that still fit.")
