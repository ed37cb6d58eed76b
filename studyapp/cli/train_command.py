"""`motionjury train`, for feature networks and for every generator that learns."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from generators.registry import (
    TRAINABLE,
    Device,
    Trainable,
    TrainingChoice,
    TrainingRequest,
)
from motion.errors import InputError
from studyapp.cli.arguments import FILE, FOLDER, Decorator, Number, device_option, together
from studyapp.cli.main import LazyGroup
from studyapp.cli.output import echo_note, echo_skipped, progress
from training.run.launching import is_leader
from training.run.records import run_folder

if TYPE_CHECKING:
    from analysis.evaluators.clip_views import Channels
    from analysis.evaluators.evaluator import EvaluatorFacts, Kind


class _Networks(LazyGroup):
    """The evaluator, and every generator that learns, which is looked up when asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [*super().list_commands(ctx), *TRAINABLE]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in TRAINABLE:
            return generator_command(cmd_name)
        return super().get_command(ctx, cmd_name)


@click.group("train", cls=_Networks)
def command() -> None:
    """Train networks on your own recordings."""


def _training_options(*, smallest_batch: int) -> Decorator:
    """Return the options of every training; its config has the numbers that are not given."""
    return together(
        click.option("--steps", type=click.IntRange(1), help="Number of updates."),
        click.option(
            "--batch-size", type=click.IntRange(smallest_batch), help="Windows per update."
        ),
        click.option("--learning-rate", type=Number(0, 1, min_open=True)),
        click.option("--seed", type=click.IntRange(0), default=0),
        device_option,
    )


@command.command("evaluator")
@click.argument("kind", type=click.Choice(["emotion", "motion", "face"]))
@click.option(
    "--data",
    required=True,
    type=click.Path(path_type=Path),
    help="A study folder, whose condition ground_truth is read, or a folder of motion files; for "
    "the kind emotion, with a segments.csv that has the columns name and emotion.",
)
@click.option(
    "--channels",
    type=click.Choice(["gesture", "expression", "both"]),
    help="For the kind motion: its input (for FGD, FED or FMD).  [default: gesture]",
)
@click.option(
    "--config",
    "size",
    type=click.Choice(["full", "tiny"]),
    default="full",
    help="The papers' sizes, which need a GPU and hours of recordings, or small ones that a CPU "
    "trains in minutes.",
)
@click.option(
    "--out",
    type=FILE,
    help="The network's file. By default KIND.safetensors in the study's folder evaluators, where "
    "'motionjury metrics' finds it, or in the working directory.",
)
@_training_options(smallest_batch=2)
def evaluator(
    kind: Kind,
    data: Path,
    channels: Channels | None,
    size: str,
    out: Path | None,
    device: str,
    **training: Any,
) -> None:
    """Train a feature network for automatic metrics on recorded motion.

    KIND is emotion (AMUSE's evaluator: FGD and gesture emotion accuracy), motion (an autoencoder
    as in BEAT and DiffSHEG: FGD, FED, FMD) or face (an autoencoder of face landmarks as in
    Speech2UnifiedExpressions: FLD). Run the same command again to continue an interrupted run.
    """
    # Imported here: torch takes seconds to load, which --help should not wait for.
    from analysis.evaluators.training import (
        CHANNELS_OF_KIND,
        PRESETS,
        EvaluatorRequest,
        train_evaluator,
    )
    from motion.body.face_landmarks import FaceLandmarks
    from studyapp.stimuli.training_recordings import recordings_of

    if channels is not None and kind != "motion":
        raise InputError(
            f"--channels is for the kind motion, not {kind}",
            remedy=f"Omit it: the input of a network of kind {kind} is that of its paper",
        )
    recordings = recordings_of(data, show_note=echo_note)
    request = EvaluatorRequest(
        channels=channels or CHANNELS_OF_KIND[kind],
        preset=PRESETS[kind][size],
        changes={key: value for key, value in training.items() if value is not None},
        frozen=recordings.frozen,
        landmarks=FaceLandmarks.of(recordings.read_body()) if kind == "face" else None,
        device=device,
    )
    name = f"{kind}-{channels}" if channels else kind
    target = out or recordings.networks / f"{name}.safetensors"
    with (
        training_run(target),
        progress("read", "clip") as show_reading,
        progress("train", "step") as show_training,
    ):
        facts, skipped = train_evaluator(
            request,
            recordings.sources,
            target,
            show_reading=show_reading,
            show_training=show_training,
        )
    if is_leader():
        echo_skipped(skipped, "clip")
        _print_result(facts, target)


def _print_result(facts: EvaluatorFacts, target: Path) -> None:
    data, held_out = facts.data, facts.held_out
    click.echo(
        f"Learned from {data['windows']} windows of {data['clips']} clips; held out "
        f"{data['held_out']} ({data['held_out_windows']} windows)."
    )
    if facts.labels:
        click.echo(
            f"Accuracy on held-out data with {len(facts.labels)} emotions: "
            f"{held_out['accuracy']:.3f}; of always choosing the most frequent: "
            f"{held_out['largest_share']:.3f}."
        )
        learned = held_out["accuracy"] > held_out["largest_share"]
    else:
        click.echo(
            f"Reconstruction error on held-out data: {held_out['error']:.3f} standard deviations; "
            f"of the mean pose: {held_out['error_of_mean']:.3f}."
        )
        learned = held_out["error"] < held_out["error_of_mean"]
    if not learned:
        click.echo(
            "The network is no better than that baseline on held-out recordings, so its scores "
            "mean little: use more recordings or more steps.",
            err=True,
        )
    click.echo(f"Wrote {target}, with the weights of step {facts.training['best_step']}")


@contextmanager
def training_run(out: Path) -> Iterator[None]:
    """Guard a training that writes `out`; an interruption says where it was saved.

    Raises
    ------
    InputError
        If `out` exists without the run that made it.
    """
    # Imported here: torch takes seconds to load, which --help should not wait for.
    from training.run.loop import TrainingStopped

    run = run_folder(out)
    if out.exists() and not (run / "checkpoint.safetensors").exists():
        raise InputError(
            "this file exists, but not the run that made it",
            where=out,
            remedy="Choose another --out, or move the file away",
        )
    try:
        yield
    except TrainingStopped as stop:
        if is_leader():
            steps = f"step {stop.step} of {stop.steps}"
            click.echo(f"\nStopped after {steps}; saved in {run}", err=True)
        raise


_CONFIG_OPTIONS: Final = ("steps", "batch_size", "learning_rate", "precision", "accumulate")
"""Options that override a field of the training's config."""


def generator_command(name: str) -> click.Command:
    """Return the command that trains generator `name`."""
    trainable = TRAINABLE[name]
    configs = "; ".join(f"{config}: {words}" for config, words in trainable.configs.items())
    explanation = " ".join(trainable.explanation.split())
    with_options = together(
        click.option(
            "--data",
            required=True,
            type=FOLDER,
            help="Recordings laid out as BEAT, BEAT2, SHOW or by 'motionjury corpus'.",
        ),
        click.option("--split", type=FILE, help="A list of the split that each take belongs to."),
        click.option(
            "--config",
            type=click.Choice(list(trainable.configs)),
            default=next(iter(trainable.configs)),
            help=f"{configs}.",
        ),
        click.option(
            "--out",
            type=FILE,
            default=Path(f"{name}.safetensors"),
            help="The network's file; the training run is stored beside it.",
        ),
        *(
            click.option(
                f"--{choice.name.replace('_', '-')}", type=_type_of(choice), help=choice.help
            )
            for choice in trainable.choices
        ),
        _training_options(smallest_batch=1),
        click.option(
            "--accumulate",
            type=click.IntRange(1),
            help="Split each update into this many parts, to save memory.",
        ),
        click.option(
            "--precision",
            type=click.Choice(["float32", "bfloat16"]),
            help="Precision of the layers that need less than float32.",
        ),
    )
    return click.command(
        name,
        short_help=trainable.summary,
        help=f"{trainable.summary}\n\n{explanation}\n\n"
        "Run the same command again to continue an interrupted run.",
    )(with_options(partial(_train_generator, name, trainable)))


def _type_of(choice: TrainingChoice) -> click.ParamType[Any]:
    if choice.values:
        return click.Choice(choice.values)
    return FILE if choice.file else FOLDER


def _train_generator(
    name: str,
    trainable: Trainable,
    *,
    data: Path,
    split: Path | None,
    config: str,
    out: Path,
    seed: int,
    device: Device,
    **options: Any,
) -> None:
    # Imported here: torch takes seconds to load, which --help should not wait for.
    from training.data.folders import read_takes

    given = {key: value for key, value in options.items() if value is not None}
    with training_run(out):
        takes = read_takes(data, split_list=split)
        if is_leader():
            for note in takes.notes:
                click.echo(note)
        with progress("prepare", "take") as take, progress("train", "step") as step:
            request = TrainingRequest(
                takes=takes,
                out=out,
                cache=out.parent / "features",
                config=config,
                changes={
                    "seed": seed,
                    **{key: given[key] for key in _CONFIG_OPTIONS if key in given},
                },
                choices={
                    choice.name: str(given[choice.name])
                    for choice in trainable.choices
                    if choice.name in given
                },
                device=device,
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
        click.echo(f"Wrote {out}. Use it with '{trainable.taken_by.format(out=out)}'.")
