from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from motion.formats.beat_tracks import SemanticSpan, read_semantic_scores
from motion.segment import write_segments
from studyapp.results.export.shared_folder import copy_study
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder

MakeTake = Callable[..., Take]


def write_companion(take: Take, ending: str, text: str) -> Path:
    assert take.motion is not None
    path = take.motion.with_suffix(ending)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("segment", "ending", "text", "transcripts", "note"),
    [
        (None, ".lab", "Good morning,\neverybody.\n", ["Good morning, everybody."], "is from"),
        (
            2.0,
            ".csv",
            "word,start,end\nGood,0.5,0.9\nmorning,1.9,2.3\nall,4.1,4.5\n",
            ["good", "morning", "all"],
            "is from",
        ),
        (2.0, ".csv", "word,start,end\nlate,50,51\n", [""] * 3, "transcript is of other speech"),
    ],
)
def test_each_segment_gets_its_own_words_unless_they_are_of_other_speech(
    folder: StudyFolder,
    take: MakeTake,
    segment: float | None,
    ending: str,
    text: str,
    transcripts: list[str],
    note: str,
) -> None:
    recorded = take(segment=segment)
    write_companion(recorded, ending, text)
    segments, notes = import_take(folder, recorded)
    assert [each.transcript for each in segments] == transcripts
    assert list(folder.segments()) == segments
    assert any(note in each and f"motion{ending}" in each for each in notes)


def test_known_transcripts_stay(folder: StudyFolder, take: MakeTake) -> None:
    first = take(segment=None)
    (segment,), _ = import_take(folder, first)
    write_segments(folder.speech, [replace(segment, transcript="Known.")])
    import_take(folder, replace(first, condition="ours"))
    assert [segment.transcript for segment in folder.segments()] == ["Known."]


def test_semantic_scores_are_imported_and_passed_on(folder: StudyFolder, take: MakeTake) -> None:
    cut = take()
    write_companion(cut, ".txt", "beat\t1.500\t2.500\t1.000\t0.700\t\n")
    import_take(folder, cut)
    assert read_semantic_scores(folder.semantics("take_01")) == (
        SemanticSpan(start=1.5, end=2, score=0.7),
    )
    assert read_semantic_scores(folder.semantics("take_02")) == (
        SemanticSpan(start=0, end=0.5, score=0.7),
    )
    assert read_semantic_scores(folder.semantics("take_03")) == ()
    copied = StudyFolder(folder.root.with_name("copied"))
    copy_study(folder, folder.study(), copied, videos=False)
    assert copied.semantics("take_01").read_text() == folder.semantics("take_01").read_text()
