"""`motionjury train NAME`, for every generator that learns."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, get_args

import click

from generators.registry import (
    Device,
    Trainable,
    TrainingChoice,
    TrainingRequest,
    find_trainable,
    run_folder,
)
from motion.errors import InputError
from studyapp.cli.output import echo_skipped, progress
from training.data.take import KINDS
from training.run.launching import is_leader


@contextmanager
def run_into(out: Path) -> Iterator[None]:
    """Train the network of the file `out` during the block; an interruption says what was saved.

    Raises
    ------
    InputError
        If the file is there, and not the run that made it.
    """
    # Imported here: torch takes seconds to load, which --help need not wait for.
    from training.run.loop import TrainingStopped

    run = run_folder(out)
    if out.exists() and not (run / "checkpoint.safetensors").exists():
        raise InputError(
            "there is a file already, and not the run that would go on to make it",
            where=out,
            remedy="Name another --out, or move the file away",
        )
    try:
        yield
    except TrainingStopped as stopped:
        if is_leader():
            steps = f"step {stopped.step} of {stopped.steps}"
            click.echo(f"\nStopped after {steps}; saved in {run}", err=True)
        raise


_CHANGES: Final = ("steps", "batch_size", "learning_rate", "precision", "accumulate")
"""Options that change a field of the training's config where they are given."""

_folder = click.Path(file_okay=False, path_type=Path)
_file = click.Path(dir_okay=False, path_type=Path)


def generator_command(name: str) -> click.Command:
    """Return the command that trains generator `name`."""
    trainable = find_trainable(name)

    def callback(**given: Any) -> None:
        _train(name, trainable, given)

    sizes = "; ".join(f"{size}: {what}" for size, what in trainable.configs.items())
    options = [
        click.Option(
            ["--data"],
            required=True,
            type=_folder,
            help="Recordings as BEAT, BEAT2, SHOW or 'motionjury corpus' lay them out.",
        ),
        click.Option(
            ["--kind"],
            type=click.Choice(KINDS),
            help="Layout of --data, if its content does not tell.",
        ),
        click.Option(["--split"], type=_file, help="A list that says what each take is for."),
        click.Option(
            ["--config"],
            type=click.Choice(list(trainable.configs)),
            default=next(iter(trainable.configs)),
            show_default=True,
            help=f"{sizes}.",
        ),
        click.Option(
            ["--out"],
            type=_file,
            default=Path(f"{name}.safetensors"),
            show_default=True,
            help="The network's file; the run is kept beside it.",
        ),
        click.Option(
            ["--cache"],
            type=_folder,
            help="Keeps the recordings' features; by default the folder features beside --out.",
        ),
        *(
            click.Option(
                [f"--{choice.name.replace('_', '-')}"],
                type=_type_of(choice),
                help=choice.help,
            )
            for choice in trainable.choices
        ),
        click.Option(["--steps"], type=click.IntRange(1), help="Updates of the weights."),
        click.Option(["--batch-size"], type=click.IntRange(1), help="Windows in an update."),
        click.Option(["--learning-rate"], type=click.FloatRange(0, 1, min_open=True)),
        click.Option(
            ["--accumulate"],
            type=click.IntRange(1),
            help="Compute each update in so many parts, if memory is short.",
        ),
        click.Option(
            ["--precision"],
            type=click.Choice(["float32", "bfloat16", "float16"]),
            help="Of the layers that can do with less than float32.",
        ),
        click.Option(["--seed"], type=click.IntRange(0), default=0, show_default=True),
        click.Option(
            ["--device"],
            type=click.Choice(get_args(Device)),
            default="cpu",
            show_default=True,
        ),
        click.Option(
            ["--processes"],
            type=click.IntRange(1),
            default=1,
            show_default=True,
            help="Processes that train together on this machine; one for each graphics processor.",
        ),
    ]
    return click.Command(
        name,
        params=list(options),
        callback=callback,
        short_help=trainable.summary,
        help=f"{trainable.summary}\n\n{_paragraph(trainable.explanation)}\n\n"
        "An interrupted run goes on when the same command is given.",
    )


def _type_of(choice: TrainingChoice) -> click.ParamType[Any]:
    if choice.values:
        return click.Choice(choice.values)
    return _file if choice.file else _folder


def _paragraph(text: str) -> str:
    return " ".join(text.split())


def _train(name: str, trainable: Trainable, given: dict[str, Any]) -> None:
    # Imported here: torch takes seconds to load, which --help need not wait for.
    from training.data.folders import read_takes
    from training.run.launching import group_size, is_leader, run_in_processes

    out: Path = given["out"]
    if given["processes"] > 1 and group_size() == 1:
        sys.exit(run_in_processes(given["processes"], [sys.executable, *sys.orig_argv[1:]]))
    with run_into(out):
        takes = read_takes(given["data"], kind=given["kind"], split_list=given["split"])
        if is_leader():
            for note in takes.notes:
                click.echo(note)
        with progress("prepare", "take") as take, progress("train", "step") as step:
            request = TrainingRequest(
                takes=takes,
                out=out,
                cache=given["cache"] or out.parent / "features",
                config=given["config"],
                changes={
                    "seed": given["seed"],
                    **{key: given[key] for key in _CHANGES if given[key] is not None},
                },
                choices={
                    choice.name: str(given[choice.name])
                    for choice in trainable.choices
                    if given[choice.name] is not None
                },
                device=given["device"],
                show_preparing=take,
                show_training=step,
            )
            trained = trainable.load()(request)
    if is_leader():
        echo_skipped(trained.skipped, "take")
        for sentence in trained.sentences:
            click.echo(sentence)
        for warning in trained.warnings:
            click.echo(warning, err=True)
        click.echo(f"Wrote {out}; '{trainable.taken_by.format(out=out)}' takes it.")
