"""Splits of recordings: by a list, by the data set's own rule, or by hash.

Windows of one recording resemble each other, so a recording is held out as a whole.
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

HELD_OUT_SHARE: Final = 0.1
"""Share of the recordings held out for validation, and for testing, by default."""

_QUOTED_NAMES: Final = 3
"""Names that a note quotes."""


def by_list(findings: Findings, splits: SplitList) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return the takes that a list names, with their splits, and notes about the others.

    A list may use the take's name, its file's name, or its path below the folder.

    Raises
    ------
    InputError
        If it names none of the takes.
    """
    takes: list[Take] = []
    left_out: list[str] = []
    elsewhere: Counter[str] = Counter()
    known_names: set[str] = set()
    for item in findings.takes:
        names = (item.take.name, item.take.motion.stem, item.place)
        split = next((splits.splits[name] for name in names if name in splits.splits), None)
        known_names.update(names)
        if split is not None:
            takes.append(replace(item.take, split=split))
        elif other := next((splits.others[name] for name in names if name in splits.others), None):
            elsewhere[other] += 1
        else:
            left_out.append(item.take.name)
    if not takes:
        raise InputError(
            f"the split list names none of the {len(findings.takes)} takes, of which the first is "
            f"{findings.takes[0].take.name}",
            where=splits.path,
            remedy="Name takes as their files are named",
        )
    missing = sorted(name for name in (*splits.splits, *splits.others) if name not in known_names)
    notes = [f"splits by {splits.path.name}: {count_splits(takes)}"]
    if left_out:
        notes.append(f"{_quote_names(left_out, 'take')} left out, which the list does not name")
    notes += [f"{_count(number, 'take')} left out as {word}" for word, number in elsewhere.items()]
    if missing:
        notes.append(f"{_quote_names(missing, 'name')} of the list not there")
    return tuple(takes), tuple(notes)


def by_rule(findings: Findings) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return all takes with the data set's own split, or else one by hash.

    A take without a split takes that of other takes of its recording. Recordings without any are
    sorted by the hash of their name: the first tenth is for testing and the next for validation, at
    least one each if there are three or more.
    """
    given: dict[str, list[Split]] = {}
    for item in sorted(findings.takes, key=lambda item: item.take.name):
        if item.given_split:
            given.setdefault(item.recording, []).append(item.given_split)
    hashed = split_by_hash({item.recording for item in findings.takes} - set(given))
    ruled: list[Take] = []
    by_hash: list[Take] = []
    for item in findings.takes:
        if item.recording in given:
            ruled.append(replace(item.take, split=item.given_split or given[item.recording][0]))
        else:
            by_hash.append(replace(item.take, split=hashed[item.recording]))
    divided = sum(len(set(splits)) > 1 for splits in given.values())
    notes = []
    if ruled:
        notes.append(f"splits by {findings.split_rule}: {count_splits(ruled)}")
    if divided:
        notes.append(
            f"{_count(divided, 'recording')} cut into takes of several splits, so that held-out "
            "takes resemble others"
        )
    if by_hash:
        notes.append(f"splits by the hash of each recording's name: {count_splits(by_hash)}")
    return (*ruled, *by_hash), tuple(notes)


def split_by_hash(recordings: Iterable[str]) -> dict[str, Split]:
    """Return a split of each recording that depends only on the set of names."""
    order = sorted(recordings, key=lambda name: hashlib.sha256(name.encode()).digest())
    count = max(round(HELD_OUT_SHARE * len(order)), 1 if len(order) > 2 else 0)
    splits: dict[str, Split] = dict.fromkeys(order, "train")
    splits.update(dict.fromkeys(order[:count], "test"))
    splits.update(dict.fromkeys(order[count : 2 * count], "validation"))
    return splits


def count_splits(takes: Sequence[Take]) -> str:
    """Return the number of takes in each split, in words."""
    takes_of_split = Counter(take.split for take in takes)
    return listed([f"{takes_of_split[split]} {split}" for split in SPLITS])


def _quote_names(names: Sequence[str], noun: str) -> str:
    """Return ``12 takes (a, b, c, …)``."""
    quoted = ", ".join(names[:_QUOTED_NAMES])
    return f"{_count(len(names), noun)} ({quoted}{', …' if len(names) > _QUOTED_NAMES else ''})"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' if number != 1 else ''}"


def held_out_recordings(
    recordings: Sequence[str], labels: Sequence[str], *, share: float, seed: int
) -> frozenset[str]:
    """Return the names of the recordings to hold out.

    Parameters
    ----------
    recordings : sequence of str
        The recording that each clip is from.
    labels : sequence of str
        The label of each clip; the same for all if there are none. Each label keeps at least one
        recording for training.
    share : float
        Share of each label's recordings, above 0 and below 1; at least one if there are two.
    seed : int
        Not negative.

    Returns
    -------
    frozenset of str
        Empty if no label has two recordings.
    """
    label_counts: dict[str, Counter[str]] = {}
    for recording, label in zip(recordings, labels, strict=True):
        label_counts.setdefault(recording, Counter())[label] += 1
    by_label: dict[str, list[str]] = {}
    for recording in sorted(label_counts):
        count_splits = label_counts[recording]
        main_label = max(sorted(count_splits), key=lambda label: count_splits[label])
        by_label.setdefault(main_label, []).append(recording)
    chance = np.random.default_rng(seed)
    held_out: list[str] = []
    for label in sorted(by_label):
        names = by_label[label]
        count = min(len(names) - 1, max(1, round(share * len(names))))
        chosen = chance.permutation(len(names))[: max(0, count)]
        held_out += [names[index] for index in chosen]
    return frozenset(held_out)
