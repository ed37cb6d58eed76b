"""Making a corpus: every take in turn or several at once, resuming where an earlier run stopped."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from motion.files import write_text
from motion.processes import ProcessPool
from training.corpus.plan import PlannedTake, planned_takes
from training.corpus.recording import RecordingFiles, record
from training.corpus.request import CorpusRequest, claim_folder

Show = Callable[[int, int], None]
"""Told how many takes are made, of how many."""

SPLITS: Final = "splits.csv"
TAKES: Final = "takes.csv"


@dataclass(frozen=True, kw_only=True)
class CorpusResult:
    """The outcome.

    Attributes
    ----------
    takes : tuple of PlannedTake
        All takes of the corpus.
    new_takes : int
        Number of takes made by this call; the others existed.
    """

    takes: tuple[PlannedTake, ...]
    new_takes: int


def make_corpus(
    folder: Path, request: CorpusRequest, *, processes: int = 1, show: Show | None = None
) -> CorpusResult:
    """Make a corpus in `folder`; takes that exist already are not remade.

    Parameters
    ----------
    folder : Path
        Where to; it is created if missing.
    request : CorpusRequest
        Which corpus. The same request gives the same bytes with the same version of espeak-ng.
    processes : int
        Number of processes.
    show : callable, optional
        Told how many takes are made, of how many.

    Raises
    ------
    InputError
        If the folder holds something else, or another corpus than the one asked for, or espeak-ng
        is not installed or fails.
    """
    claim_folder(folder, request)
    takes = tuple(planned_takes(request))
    missing = [take for take in takes if not RecordingFiles.of(folder, take).complete]
    report = show or (lambda done, total: None)
    existing = len(takes) - len(missing)
    for done, _ in enumerate(_record(folder, request, missing, processes), start=existing + 1):
        report(done, len(takes))
    write_text(folder / TAKES, _table(takes))
    write_text(folder / SPLITS, _splits(takes))
    return CorpusResult(takes=takes, new_takes=len(missing))


def _record(
    folder: Path, request: CorpusRequest, takes: Sequence[PlannedTake], processes: int
) -> Iterator[None]:
    """Make takes, and yield after each."""
    record_take = partial(record, folder, frame_rate=request.frame_rate)
    if processes == 1 or len(takes) < 2:
        for take in takes:
            record_take(take)
            yield
        return
    with ProcessPool(min(processes, len(takes))) as pool:
        for future in as_completed([pool.submit(record_take, take) for take in takes]):
            yield future.result()


def _splits(takes: Sequence[PlannedTake]) -> str:
    return _csv([("name", "split"), *((take.name, take.split) for take in takes)])


def _table(takes: Sequence[PlannedTake]) -> str:
    header = (
        "name", "speaker", "emotion", "take", "split", "unheard", "held_out_speaker", "text",
    )  # fmt: skip
    rows = [
        (
            take.name, take.speaker.number, take.emotion, take.take, take.split,
            int(take.unheard), int(take.held_out_speaker), take.text,
        )
        for take in takes
    ]  # fmt: skip
    return _csv([header, *rows])


def _csv(rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
