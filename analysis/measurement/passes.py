"""Looking at all motion files once more: with each network, and on a body."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from analysis.evaluators.feature_networks import Network
from analysis.measurement.clip_features import ClipFeatures, FeaturesOf
from analysis.measurement.feature_scores import FeatureScores, feature_scores
from analysis.measurement.measured_clips import Bench
from analysis.measurement.penetration_of_files import Depths, DepthsOf
from analysis.measurement.segment_scores import ClipScore, SegmentFiles
from analysis.measurement.workers import Steps, Workers
from analysis.metrics.self_penetration import self_penetration


def motions(files: SegmentFiles) -> Iterator[Path]:
    """Yield all motion files of a segment, its recording among them."""
    yield from files.clips.values()
    if files.recorded is not None:
        yield files.recorded


def features_of_files(
    network: Network, bench: Bench, files: Sequence[Path], workers: Workers, steps: Steps
) -> dict[Path, ClipFeatures]:
    """Return what a network says about each motion file."""
    look = FeaturesOf(
        network=network,
        motion=bench.motion,
        folder=bench.store.folder if bench.store is not None else None,
    )
    if network.sees and network.sees <= set(bench.motion.frozen):
        held = ClipFeatures(reason=f"the study holds still: {', '.join(sorted(network.sees))}")
        steps.of(files)(len(files), len(files))
        return dict.fromkeys(files, held)
    found = dict(zip(files, workers.each(look, files, steps.of(files)), strict=True))
    look.forget_others({one.kept for one in found.values() if one.kept is not None})
    return found


def depths_of_files(
    look: DepthsOf, files: Sequence[Path], workers: Workers, steps: Steps
) -> dict[Path, Depths]:
    """Return how deep the arms are in each motion file."""
    found = dict(zip(files, workers.each(look, files, steps.of(files)), strict=True))
    look.forget_others({one.kept for one in found.values() if one.kept is not None})
    return found


def penetrations(
    found: Sequence[SegmentFiles], depths: Mapping[Path, Depths], body: str
) -> Iterator[ClipScore]:
    """Yield the self-penetration of every clip."""
    for files in found:
        for condition, path in files.clips.items():
            if path in depths and len(depths[path].metres):
                for result in self_penetration(depths[path].metres, body=body):
                    yield ClipScore(condition=condition, segment=files.segment, result=result)


def scores_of_network(
    network: Network,
    conditions: Sequence[str],
    found: Sequence[SegmentFiles],
    features: Mapping[Path, ClipFeatures],
    emotions: Mapping[str, str] | None,
    damaged: Collection[str],
) -> FeatureScores:
    """Return the scores of one network; files that are named as unusable do not count as clips."""
    usable = {path: one for path, one in features.items() if str(path) not in damaged}
    recorded = {files.segment: files.recorded for files in found if files.recorded is not None}
    by_condition = {
        condition: {
            files.segment: usable[files.clips[condition]]
            for files in found
            if files.clips.get(condition) in usable
        }
        for condition in conditions
    }
    return feature_scores(
        network,
        {condition: clips for condition, clips in by_condition.items() if clips},
        {segment: usable[path] for segment, path in recorded.items() if path in usable},
        recordings=recorded_conditions(conditions, found),
        emotions=emotions,
    )


def recorded_conditions(conditions: Iterable[str], found: Sequence[SegmentFiles]) -> frozenset[str]:
    """Return the conditions that are recorded motion themselves."""
    return frozenset(
        condition
        for condition in conditions
        if all(
            files.clips[condition] == files.recorded for files in found if condition in files.clips
        )
    )
