from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from motion.audio import read_audio
from motion.errors import InputError
from motion.formats.beat_tracks import read_semantic_scores
from motion.formats.bvh import read_bvh
from motion.formats.transcript import read_transcript
from tests.support.sounds import needs_espeak
from training.corpus.making import files_of, make_corpus
from training.corpus.plan import CorpusRequest, planned_takes
from training.corpus.process import Process
from training.corpus.speakers import speaker_of
from training.data.folders import read_takes
from training.spaces.beat import body_values

pytestmark = needs_espeak

REQUEST = CorpusRequest(speakers=1, sentences=8, takes=1, held_out_speakers=0, frame_rate=15)


def contents(folder: Path) -> dict[Path, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder): path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("corpora") / "corpus"
    make_corpus(folder, REQUEST)
    return folder


def test_the_beat_reader_reads_it_without_warnings(corpus: Path) -> None:
    result = read_takes(corpus)
    assert result.kind == "beat"
    assert result.skipped == ()
    planned = {take.name: take for take in planned_takes(REQUEST)}
    assert {take.name for take in result.takes} == set(planned)
    for take in result.takes:
        expected = planned[take.name]
        assert (take.emotion, take.split) == (expected.emotion, expected.split)
        speech, motion = read_audio(take.speech), read_bvh(take.motion)
        assert (len(motion.joints), motion.values.shape[1]) == (75, 228)
        assert len(motion.values) == round(speech.duration * motion.frame_rate)
        assert take.face is not None
        assert take.semantic is not None
        assert read_semantic_scores(take.semantic)
        assert take.transcript is not None
        assert len(read_transcript(take.transcript, speech)) > 10


def test_the_truth_can_be_computed_from_the_files_alone(corpus: Path) -> None:
    take = read_takes(corpus).takes[0]
    truth = np.load(corpus / "truth" / f"{take.name}.npz")
    speaker = speaker_of(int(truth["speaker"]), REQUEST.seed)
    process = Process.from_speech(read_audio(take.speech), take.emotion, speaker)
    result = process.drive(float(truth["frame_rate"]))
    for field in fields(result):
        np.testing.assert_allclose(
            getattr(result, field.name), truth[f"drive_{field.name}"], atol=1e-5
        )
    assert len(truth["stroke_times"]) == len(truth["stroke_delays"]) > 3
    body = body_values(read_bvh(take.motion))
    assert np.linalg.norm(body, axis=1).max() < 20


def test_a_corpus_resumed_by_two_processes_ends_in_the_same_bytes(
    corpus: Path, tmp_path: Path
) -> None:
    again = tmp_path / "again"

    def stop(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_corpus(again, REQUEST, show=stop)
    there = files_of(again, next(planned_takes(REQUEST)))
    assert all(path.exists() for path in there.values())
    assert not (again / "splits.csv").exists()
    there["face"].unlink()
    takes, new_takes = make_corpus(again, REQUEST, processes=2)
    assert new_takes == len(takes) - 1
    assert contents(again) == contents(corpus)


def test_a_folder_with_another_corpus_or_other_files_is_not_touched(
    corpus: Path, tmp_path: Path
) -> None:
    before = contents(corpus)
    with pytest.raises(InputError, match="holds another corpus"):
        make_corpus(corpus, replace(REQUEST, seed=2))
    assert contents(corpus) == before
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(InputError, match="not empty"):
        make_corpus(tmp_path, REQUEST)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
