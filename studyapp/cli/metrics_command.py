"""`motionjury metrics`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from analysis.evaluators.feature_networks import PublishedFile, Source
from analysis.evaluators.network_names import PUBLISHED
from analysis.measurement.presets import PRESETS
from analysis.measurement.score_tables import check_ending, write_scores
from analysis.measurement.scores import ConditionScore, StudyMetrics
from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from motion.errors import InputError
from studyapp.cli.arguments import optional_study_folder, study_here
from studyapp.cli.arguments import processes as processes_option
from studyapp.cli.output import echo_skipped, echo_table, progress
from studyapp.results.metrics import measure_folders, measure_study
from studyapp.study.folder import StudyFolder

_folder = click.Path(path_type=Path, file_okay=False)


@click.command("metrics")
@optional_study_folder
@click.option("--generated", type=_folder, help="Motion files, or a folder of them per condition.")
@click.option("--reference", type=_folder, help="Recorded motion of the same speech.")
@click.option("--speech", type=_folder, help="Recordings named as the motion files are.")
@click.option("--semantics", type=_folder, help="BEAT's semantic scores of the reference, .txt.")
@click.option(
    "--preset",
    "presets",
    type=click.Choice(sorted(PRESETS)),
    multiple=True,
    help="Which metrics, computed as which paper does; may be repeated. All by default.",
)
@click.option(
    "--evaluator",
    "evaluators",
    metavar="FILE | PRESET=FILE",
    multiple=True,
    callback=lambda context, parameter, given: tuple(map(_evaluator, given)),
    help="A feature network that 'train evaluator' made, or a published one such as "
    "emage=AESKConv_240_100.bin (emage, beat, ted, talkshow); may be repeated. A study finds "
    "those in its folder evaluators, and those it names, by itself.",
)
@click.option("--penetration", is_flag=True, help="Look for arms inside the body too; slow.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Where scores go, those of every clip too: .csv, .json or .parquet. By default "
    "metrics.parquet in the study folder.",
)
@click.option(
    "--fps",
    type=click.FloatRange(MIN_FRAME_RATE, MAX_FRAME_RATE),
    help="With --generated: frames per second of all motion files, in place of what they state.",
)
@processes_option
def command(
    folder: StudyFolder | None,
    generated: Path | None,
    reference: Path | None,
    speech: Path | None,
    semantics: Path | None,
    presets: tuple[str, ...],
    evaluators: tuple[Source, ...],
    penetration: bool,
    out: Path | None,
    fps: float | None,
    processes: int,
) -> None:
    """Compute automatic metrics of the study FOLDER, or of motion files without any study.

    Metrics that compare with recorded motion need the condition ground_truth, or --reference;
    beat alignment needs the study's speech, or --speech.
    """
    if folder is None and generated is None:
        folder = study_here()
    if (folder is None) == (generated is None):
        raise InputError(
            "metrics are computed of a study or of folders, not of both or neither",
            remedy="Give a study folder, or --generated with a folder of motion files",
        )
    if folder is not None and (reference or speech or semantics or fps):
        raise InputError(
            "--reference, --speech, --semantics and --fps are for folders without a study",
            remedy="Leave them out, or give --generated in place of the study folder",
        )
    target = out if folder is None else out or folder.metrics
    if target is not None:
        check_ending(target)
    wanted = presets or tuple(PRESETS)
    with progress("metrics", "step") as show:
        if folder is not None:
            metrics = measure_study(
                folder,
                presets=wanted,
                processes=processes,
                evaluators=evaluators,
                penetration=penetration,
                on_progress=show,
            )
        elif generated is not None:
            metrics = measure_folders(
                generated,
                reference,
                speech,
                presets=wanted,
                processes=processes,
                evaluators=evaluators,
                penetration=penetration,
                semantics=semantics,
                file_rate=fps,
                on_progress=show,
            )
    _print(metrics.conditions)
    _say_what_is_missing(metrics)
    if target is not None:
        write_scores(metrics, target)
        click.echo(f"Wrote {len(metrics.clips)} scores of clips to {target}")
    if not metrics.clips:
        raise InputError(
            "no motion file could be measured", remedy="Fix what is named above and run it again"
        )


def _evaluator(given: str) -> Source:
    """Return the network that ``FILE`` or ``PRESET=FILE`` names."""
    preset, equals, file = given.partition("=")
    if equals and preset in PUBLISHED:
        return PublishedFile(preset=preset, file=Path(file))
    return Path(given)


def _print(scores: Sequence[ConditionScore]) -> None:
    """Print a row for each metric, a column for each condition."""
    conditions = list(dict.fromkeys(score.condition for score in scores))
    found = {(score.name, score.condition): score for score in scores}
    rows = []
    for name, first in {score.name: score for score in reversed(scores)}.items():
        unit = f", {first.unit}" if first.unit else ""
        better = "" if first.better == "unsaid" else first.better
        values = (_value(found.get((name, condition))) for condition in conditions)
        rows.append([f"{name}{unit}", *values, better])
    echo_table(["metric", *conditions, "better"], reversed(rows))


def _value(score: ConditionScore | None) -> str:
    if score is None or math.isnan(score.value):
        return "–"
    if score.interval is not None:
        low, high = score.interval
        return f"{score.value:.4g} [{low:.3g}, {high:.3g}]"
    spread = "" if math.isnan(score.spread) else f" ± {score.spread:.2g}"
    return f"{score.value:.4g}{spread}"


def _reasons(scores: Sequence[ConditionScore]) -> Iterator[str]:
    """Yield each reason for a missing score, or remark on one, with all that it is about."""
    conditions = {score.condition for score in scores}
    about: dict[str, dict[str, list[str]]] = {}
    for score in scores:
        for words in filter(None, (score.reason, score.remark)):
            about.setdefault(words, {}).setdefault(score.name, []).append(score.condition)
    for words, names in about.items():
        by_conditions: dict[tuple[str, ...], list[str]] = {}
        for name, lacking in names.items():
            by_conditions.setdefault(tuple(lacking), []).append(name)
        for those, named in by_conditions.items():
            where = "" if set(those) == conditions else f"{', '.join(those)}: "
            yield f"{where}{', '.join(named)}: {words}"


def _say_what_is_missing(metrics: StudyMetrics) -> None:
    """Say why scores are missing, and which files were left out."""
    for sentence in _reasons(metrics.conditions):
        click.echo(sentence, err=True)
    for remark in metrics.remarks:
        click.echo(remark, err=True)
    echo_skipped([file.error() for file in metrics.skipped], "file")
