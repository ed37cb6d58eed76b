"""`motionjury train`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from generators.registry import run_folder, trainable_names
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError
from studyapp.cli.material.train_generator_command import generator_command, run_into
from studyapp.cli.output import echo_skipped, progress
from studyapp.study.settings.study import GROUND_TRUTH
from training.run.launching import is_leader

if TYPE_CHECKING:
    from analysis.evaluators.clip_views import Channels
    from analysis.evaluators.design import Kind, Size
    from analysis.evaluators.training import TrainedEvaluator


class _Networks(click.Group):
    """Feature networks, and whatever generator learns; the latter are looked up when asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [*super().list_commands(ctx), *trainable_names()]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in trainable_names():
            return generator_command(cmd_name)
        return super().get_command(ctx, cmd_name)


@click.group("train", cls=_Networks)
def command() -> None:
    """Train networks on your own recordings."""


@command.command("evaluator")
@click.argument("kind", type=click.Choice(["emotion", "motion", "face"]))
@click.option(
    "--data",
    required=True,
    type=click.Path(path_type=Path),
    help="A study folder, or a folder of motion files; for emotion with a segments.csv of the "
    "columns name and emotion.",
)
@click.option(
    "--condition",
    default=GROUND_TRUTH,
    show_default=True,
    help="Of a study: the condition that is recorded motion.",
)
@click.option(
    "--channels",
    type=click.Choice(["gesture", "expression", "both"]),
    help="Of kind motion: what it looks at (for FGD, FED or FMD). Gestures by default.",
)
@click.option(
    "--config",
    "size",
    type=click.Choice(["full", "tiny"]),
    default="full",
    show_default=True,
    help="The papers' sizes, which ask for a graphics processor and hours of recordings, or small "
    "ones that a processor trains in a minute or two.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The network's file. By default KIND.safetensors in the study's folder evaluators, where "
    "'motionjury metrics' finds it; without a study in the working directory.",
)
@click.option("--steps", type=click.IntRange(1), help="Updates of the weights.")
@click.option("--batch-size", type=click.IntRange(2), help="Windows in an update.")
@click.option("--learning-rate", type=click.FloatRange(0, 1, min_open=True))
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option("--device", type=click.Choice(["cpu", "cuda"]), default="cpu", show_default=True)
@click.option(
    "--fps",
    type=click.FloatRange(MIN_FRAME_RATE, MAX_FRAME_RATE),
    help="Of a folder: frames per second of all motion files, in place of what they state.",
)
@click.option(
    "--body",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Of a folder: an SMPL-X body (.npz), where clips tell the face in its expressions.",
)
def evaluator(
    kind: str,
    data: Path,
    condition: str,
    channels: str | None,
    size: str,
    out: Path | None,
    steps: int | None,
    batch_size: int | None,
    learning_rate: float | None,
    seed: int,
    device: str,
    fps: float | None,
    body: Path | None,
) -> None:
    """Train a feature network for automatic metrics on recorded motion.

    KIND is emotion (AMUSE's evaluator: FGD and gesture emotion accuracy), motion (an autoencoder
    as in BEAT and DiffSHEG: FGD, FED, FMD) or face (an autoencoder of face landmarks as in
    Speech2UnifiedExpressions: FLD). An interrupted run goes on when the same command is given.
    """
    # Imported here: torch takes seconds to load, which --help need not wait for.
    from analysis.evaluators.design import CHANNELS_OF_KIND, TRAINING, EvaluatorRequest
    from analysis.evaluators.training import train_evaluator
    from motion.body.face_landmarks import FaceLandmarks
    from studyapp.stimuli.training_recordings import recordings_of
    from training.run.records import RunFolder

    if channels is not None and kind != "motion":
        raise InputError(
            f"--channels is for the kind motion, not {kind}",
            remedy=f"Leave it out: a network of kind {kind} looks at what its paper's looks at",
        )
    seen = CHANNELS_OF_KIND[cast("Kind", kind)][0] if channels is None else channels
    usual = TRAINING[cast("Kind", kind), cast("Size", size)]
    training = replace(
        usual,
        steps=steps or usual.steps,
        batch_size=batch_size or usual.batch_size,
        learning_rate=learning_rate or usual.learning_rate,
        seed=seed,
    )
    recordings = recordings_of(data, condition=condition, file_rate=fps, body=body)
    request = EvaluatorRequest(
        kind=cast("Kind", kind),
        size=cast("Size", size),
        channels=cast("Channels", seen),
        training=training,
        frozen=recordings.frozen,
        landmarks=FaceLandmarks.of(recordings.read_body()) if kind == "face" else None,
        device=device,
    )
    name = f"{kind}-{channels}" if channels else kind
    target = out or recordings.networks / f"{name}.safetensors"
    folder = RunFolder(run_folder(target))
    with (
        run_into(target),
        progress("read", "clip") as read,
        progress("train", "step") as step,
    ):
        trained = train_evaluator(
            request, recordings.sources, target, folder, show_reading=read, show_training=step
        )
    if is_leader():
        _say(trained, target)


def _say(trained: TrainedEvaluator, target: Path) -> None:
    """Say what was learned, and from what."""
    facts = trained.facts
    echo_skipped(trained.skipped, "clip")
    click.echo(
        f"Learned from {facts.data.windows} windows of {facts.data.clips} clips; kept back "
        f"{facts.data.held_out} ({facts.data.held_out_windows} windows)."
    )
    found = facts.held_out
    if facts.kind == "emotion":
        click.echo(
            f"Tells {len(facts.labels)} emotions of what was kept back with accuracy "
            f"{found['accuracy']:.3f}; always naming the most frequent: "
            f"{found['largest_share']:.3f}."
        )
        learned = found["accuracy"] > found["largest_share"]
    else:
        click.echo(
            f"Rebuilds what was kept back with an error of {found['error']:.3f} deviations; always "
            f"the mean pose: {found['error_of_mean']:.3f}."
        )
        learned = found["error"] < found["error_of_mean"]
    if not learned:
        click.echo(
            "It does no better than that on recordings that it never saw, so its scores say "
            "little: give more recordings, or more steps.",
            err=True,
        )
    click.echo(f"Wrote {target}, with the weights of step {facts.training.best_step}")
