"""`motionjury metrics`."""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import click

from analysis.evaluators.feature_networks import PUBLISHED, PublishedFile, Source
from analysis.measurement.presets import PRESETS
from analysis.metrics.score_tables import check_ending, write_scores
from analysis.metrics.scores import ConditionScore
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError, counted
from studyapp.cli.arguments import (
    FILE,
    FOLDER,
    Number,
    current_study,
    optional_study_folder,
    processes_option,
    refuse_options,
)
from studyapp.cli.output import echo_note, echo_skipped, echo_table, progress
from studyapp.results.metrics import measure_folders, measure_study
from studyapp.study.folder import StudyFolder


@click.command("metrics")
@optional_study_folder
@click.option("--generated", type=FOLDER, help="Motion files, or a folder of them per condition.")
@click.option("--reference", type=FOLDER, help="Recorded motion of the same speech.")
@click.option("--speech", type=FOLDER, help="Recordings with the names of the motion files.")
@click.option("--semantics", type=FOLDER, help="BEAT's semantic scores of the reference (.txt).")
@click.option(
    "--preset",
    "presets",
    type=click.Choice(sorted(PRESETS)),
    multiple=True,
    help="The metrics of a paper; can be repeated.  [default: all]",
)
@click.option(
    "--evaluator",
    "evaluators",
    metavar="FILE | PRESET=FILE",
    multiple=True,
    callback=lambda context, parameter, values: tuple(map(_parse_evaluator, values)),
    help="A feature network made by 'train evaluator', or a published one such as "
    "emage=AESKConv_240_100.bin (emage, beat, ted, talkshow); can be repeated. The networks that "
    "a study names, or that are in its folder evaluators, are used anyway.",
)
@click.option("--penetration", is_flag=True, help="Also measure how far arms enter the body; slow.")
@click.option(
    "--out",
    type=FILE,
    help="The file for the scores of conditions and clips: .csv or .parquet. By default "
    "metrics.parquet in the study folder.",
)
@click.option(
    "--fps",
    type=Number(MIN_FRAME_RATE, MAX_FRAME_RATE),
    help="With --generated: frame rate of all motion files, overriding their own.",
)
@processes_option
def command(
    folder: StudyFolder | None,
    generated: Path | None,
    reference: Path | None,
    speech: Path | None,
    semantics: Path | None,
    out: Path | None,
    fps: float | None,
    **options: Any,
) -> None:
    """Compute automatic metrics of the study FOLDER, or of motion files without a study.

    Metrics that compare with recorded motion need the condition ground_truth or --reference; beat
    alignment needs the study's speech or --speech.
    """
    if folder is None and generated is None:
        folder = current_study()
    if (folder is None) == (generated is None):
        raise InputError(
            "give either a study or --generated",
            remedy="Give a study folder, or --generated with a folder of motion files",
        )
    if folder is not None:
        refuse_options(
            ("--reference", "--speech", "--semantics", "--fps"), "a study, only with --generated"
        )
    target = out if folder is None else out or folder.metrics
    if target is not None:
        check_ending(target)
    options["presets"] = options["presets"] or tuple(PRESETS)
    with progress("metrics", "step") as show:
        if folder is not None:
            metrics = measure_study(folder, **options, on_progress=show)
        elif generated is not None:
            metrics = measure_folders(
                generated,
                reference,
                speech,
                semantics=semantics,
                file_rate=fps,
                **options,
                on_progress=show,
            )
    _print_notes(metrics.notes)
    _print_scores(metrics.conditions)
    for sentence in _reasons(metrics.conditions):
        click.echo(sentence, err=True)
    for remark in metrics.remarks:
        click.echo(remark, err=True)
    echo_skipped(metrics.skipped, "file")
    if target is not None:
        write_scores(metrics, target)
        click.echo(f"Wrote {len(metrics.clips)} scores of clips to {target}")
    if not metrics.clips:
        raise InputError(
            "no motion file could be measured",
            remedy="Fix the problems above and run the command again",
        )


def _parse_evaluator(text: str) -> Source:
    """Return the network of ``FILE`` or ``PRESET=FILE``."""
    preset, equals, file = text.partition("=")
    if equals and preset in PUBLISHED:
        return PublishedFile(preset=preset, file=Path(file))
    return Path(text)


def _print_notes(notes: Iterable[str]) -> None:
    """Print what was noted on files, and on how many more of them the same."""
    alike: dict[str, list[str]] = {}
    for note in notes:
        *_folder_and_file, text = note.split(": ", 2)
        alike.setdefault(text, []).append(note)
    for first, *others in alike.values():
        echo_note(first + (f" (and {counted(len(others), 'other file')})" if others else ""))


def _print_scores(scores: Sequence[ConditionScore]) -> None:
    """Print a row per metric and a column per condition."""
    conditions = list(dict.fromkeys(score.condition for score in scores))
    by_name = {(score.name, score.condition): score for score in scores}
    rows = []
    for name, first in {score.name: score for score in reversed(scores)}.items():
        unit = f", {first.unit}" if first.unit else ""
        better = "" if first.better == "unsaid" else first.better
        values = (_format_value(by_name.get((name, condition))) for condition in conditions)
        rows.append([f"{name}{unit}", *values, better])
    echo_table(["metric", *conditions, "better"], reversed(rows))


def _format_value(score: ConditionScore | None) -> str:
    if score is None or math.isnan(score.value):
        return "–"
    if score.interval is not None:
        low, high = score.interval
        return f"{score.value:.4g} [{low:.3g}, {high:.3g}]"
    spread = "" if math.isnan(score.spread) else f" ± {score.spread:.2g}"
    return f"{score.value:.4g}{spread}"


def _reasons(scores: Sequence[ConditionScore]) -> Iterator[str]:
    """Yield each reason for a missing score, and each remark, with the metrics that have it."""
    names: dict[str, dict[str, None]] = {}
    for score in scores:
        for sentence in filter(None, (score.reason, score.remark)):
            names.setdefault(sentence, {})[score.name] = None
    return (f"{', '.join(each)}: {sentence}" for sentence, each in names.items())
