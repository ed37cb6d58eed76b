"""How many trials a participant gets from the segments that a study really has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from motion.segment import Segment


@dataclass(frozen=True, kw_only=True)
class TrialCount:
    """The trials of one participant, by kind, and why they are not what the study file asks for.

    Attributes
    ----------
    practice, main, repeat, catch, attention : int
        Presentations of each kind; `repeat` equals `practice`.
    sentences : tuple of str
        What differs from the study file and why, for people; empty where nothing does.
    """

    practice: int
    main: int
    repeat: int
    catch: int
    attention: int
    sentences: tuple[str, ...] = ()

    @property
    def presentations(self) -> int:
        """Trials that a participant sees, of all kinds."""
        return self.practice + self.main + self.repeat + self.catch + self.attention

    @property
    def analysed(self) -> int:
        """Trials whose answers are analysed."""
        return self.main + self.repeat


def planned_trials(
    segments: Sequence[Segment],
    *,
    trials: int,
    practice: int,
    catch: int,
    attention: int = 0,
    rounds: int = 1,
) -> TrialCount:
    """Count the trials of one participant with these segments.

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
    return TrialCount(
        practice=discarded,
        main=pairs - discarded,
        repeat=discarded,
        catch=catch,
        attention=attention,
        sentences=tuple(sentences),
    )


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
