"""Which recordings are for what: by a list, by the data set's own rule, or by hash.

Windows of one recording resemble each other, so that a recording is kept back whole, to see how
well a network does on what it never saw.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from motion.errors import InputError, listed
from training.data.found_take import Findings
from training.data.split_list import SplitList
from training.data.take import SPLITS, Split, Take

SHARE: Final = 0.1
"""Of the recordings, kept for validation and for testing each where nobody says anything else."""

_NAMED: Final = 3
"""Names that a note quotes."""


def by_list(findings: Findings, splits: SplitList) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return the takes that a list names, with their splits, and what to say about the others.

    A list names takes as they are called here, as their files are, or by where they lie below the
    folder.

    Raises
    ------
    InputError
        If it names none of them.
    """
    takes: list[Take] = []
    left_out: list[str] = []
    elsewhere: Counter[str] = Counter()
    used: set[str] = set()
    for one in findings.takes:
        names = (one.take.name, one.take.motion.stem, one.place)
        split = next((splits.splits[name] for name in names if name in splits.splits), None)
        used.update(names)
        if split is not None:
            takes.append(replace(one.take, split=split))
        elif other := next((splits.others[name] for name in names if name in splits.others), None):
            elsewhere[other] += 1
        else:
            left_out.append(one.take.name)
    if not takes:
        raise InputError(
            f"the split list names none of the {len(findings.takes)} takes, of which the first is "
            f"{findings.takes[0].take.name}",
            where=splits.path,
            remedy="Name takes as their files are named",
        )
    missing = sorted(name for name in (*splits.splits, *splits.others) if name not in used)
    notes = [f"splits by {splits.path.name}: {counts(takes)}"]
    if left_out:
        notes.append(f"{_some(left_out, 'take')} left out, which the list does not name")
    notes += [f"{_count(number, 'take')} left out as {word}" for word, number in elsewhere.items()]
    if missing:
        notes.append(f"{_some(missing, 'name')} of the list not there")
    return tuple(takes), tuple(notes)


def by_rule(findings: Findings) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return all takes with the split that the data set gives them, or else a hash.

    Takes of which the data set says nothing are in the split of the recording that they were cut
    from, where others of it have one. Of the rest, recordings are sorted by the hash of their name;
    the first tenth is for testing and the next for validation, at least one each of three
    recordings or more.
    """
    given: dict[str, list[Split]] = {}
    for one in sorted(findings.takes, key=lambda one: one.take.name):
        if one.given_split:
            given.setdefault(one.recording, []).append(one.given_split)
    hashed = split_by_hash({one.recording for one in findings.takes} - set(given))
    ruled: list[Take] = []
    chance: list[Take] = []
    for one in findings.takes:
        if one.recording in given:
            ruled.append(replace(one.take, split=one.given_split or given[one.recording][0]))
        else:
            chance.append(replace(one.take, split=hashed[one.recording]))
    divided = sum(len(set(splits)) > 1 for splits in given.values())
    notes = []
    if ruled:
        notes.append(f"splits by {findings.split_rule}: {counts(ruled)}")
    if divided:
        notes.append(
            f"{_count(divided, 'recording')} cut into takes of several splits, so that held-out "
            "takes resemble others"
        )
    if chance:
        notes.append(f"splits by the hash of each recording's name: {counts(chance)}")
    return (*ruled, *chance), tuple(notes)


def split_by_hash(recordings: Iterable[str]) -> dict[str, Split]:
    """Return a split of each recording that depends on nothing but all their names."""
    order = sorted(recordings, key=lambda name: hashlib.sha256(name.encode()).digest())
    kept = max(round(SHARE * len(order)), 1 if len(order) > 2 else 0)
    splits: dict[str, Split] = dict.fromkeys(order, "train")
    splits.update(dict.fromkeys(order[:kept], "test"))
    splits.update(dict.fromkeys(order[kept : 2 * kept], "validation"))
    return splits


def counts(takes: Sequence[Take]) -> str:
    """Return how many takes each split has, in words."""
    number = Counter(take.split for take in takes)
    return listed([f"{number[split]} {split}" for split in SPLITS])


def _some(names: Sequence[str], noun: str) -> str:
    """Return ``12 takes (a, b, c, …)``."""
    first = ", ".join(names[:_NAMED])
    return f"{_count(len(names), noun)} ({first}{', …' if len(names) > _NAMED else ''})"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' if number != 1 else ''}"


def held_out_recordings(
    recordings: Sequence[str], labels: Sequence[str], *, share: float, seed: int
) -> frozenset[str]:
    """Return the names of the recordings to keep back.

    Parameters
    ----------
    recordings : sequence of str
        The recording that each clip is from.
    labels : sequence of str
        The label of each clip; one and the same where there are none. Each label gives up its
        share, and keeps at least one recording to learn from.
    share : float
        Of the recordings of each label, above 0 and below 1; at least one where there are two.
    seed : int
        Not negative.

    Returns
    -------
    frozenset of str
        Empty where no label has two recordings.
    """
    of_recording: dict[str, Counter[str]] = {}
    for recording, label in zip(recordings, labels, strict=True):
        of_recording.setdefault(recording, Counter())[label] += 1
    by_label: dict[str, list[str]] = {}
    for recording in sorted(of_recording):
        counts = of_recording[recording]
        most = max(sorted(counts), key=lambda label: counts[label])
        by_label.setdefault(most, []).append(recording)
    chance = np.random.default_rng(seed)
    kept_back: list[str] = []
    for label in sorted(by_label):
        names = by_label[label]
        count = min(len(names) - 1, max(1, round(share * len(names))))
        drawn = chance.permutation(len(names))[: max(0, count)]
        kept_back += [names[index] for index in drawn]
    return frozenset(kept_back)
