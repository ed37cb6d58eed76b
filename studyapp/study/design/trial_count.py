"""How many trials a participant gets from the segments that a study really has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from motion.segment import Segment


@dataclass(frozen=True, kw_only=True)
class TrialCount:
    """The pairs of one participant, and why they are not what the study file asks for.

    Attributes
    ----------
    practice, analysed : int
        Pairs that are discarded, all of which are shown again, and pairs that are not.
    sentences : tuple of str
        What differs from the study file and why, for people; empty where nothing does.
    """

    practice: int
    analysed: int
    sentences: tuple[str, ...] = ()


def planned_trials(
    segments: Sequence[Segment], *, trials: int, practice: int, rounds: int = 1
) -> TrialCount:
    """Count the pairs of one participant with these segments.

    A segment comes in at most `rounds` analysed trials, so a study with fewer segments than its
    file asks for shows each of them so often.
    """
    pairs = min(trials, rounds * len(segments))
    discarded = min(practice, pairs)
    sentences = []
    if pairs < trials:
        sentences.append(
            f"each participant judges {pairs} pairs instead of {trials}, because the study "
            f"has {len(segments)} segments and shows each of them "
            f"{'once' if rounds == 1 else f'{rounds} times'}"
        )
    if discarded < practice:
        sentences.append(
            f"{discarded} trials are practice instead of {practice}, for the same reason"
        )
    sentences.extend(_uneven_emotions(segments, pairs / rounds))
    return TrialCount(practice=discarded, analysed=pairs, sentences=tuple(sentences))


def _uneven_emotions(segments: Sequence[Segment], pairs: float) -> list[str]:
    """Say which emotions have too few segments for an even share of `pairs` different ones."""
    available = Counter(segment.emotion for segment in segments)
    if not available:
        return []
    share = int(pairs // len(available))
    short = {emotion: count for emotion, count in available.items() if count < share}
    if not short:
        return []
    listed = ", ".join(f"{emotion} {count}" for emotion, count in short.items())
    return [
        f"the emotions are not shown equally often: an even share is {share} segments each, "
        f"but there are fewer of {listed}"
    ]
