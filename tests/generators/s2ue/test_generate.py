"""Motion of whole or live speech of any length is smooth and deterministic."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from benchmarks.seams import Windows, seam_acceleration
from generators.interface import SpeechSegment
from generators.learned_settings import S2ueSettings
from generators.s2ue.generate import S2ue
from motion.arrays import Floats32
from motion.errors import InputError
from tests.generators.conftest import spoken
from tests.generators.diffsheg.small_network import written_network as other_network
from tests.generators.s2ue.small_network import written_network


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written_network(tmp_path_factory.mktemp("s2ue") / "small.safetensors")


@pytest.fixture
def speech() -> SpeechSegment:
    return spoken("a", 7.3, 2, transcript="hello there my friend")


def generator(checkpoint: Path, **settings: object) -> S2ue:
    return S2ue(S2ueSettings.model_validate({"checkpoint": checkpoint, **settings}))


def values(generator: S2ue, speech: SpeechSegment, seed: int = 1, pieces: int = 1) -> np.ndarray:
    parts = np.array_split(speech.audio.samples, pieces)
    return np.concatenate(list(generator.stream(parts, seed=seed)))


def test_cutting_of_speech_does_not_change_the_motion(
    checkpoint: Path, speech: SpeechSegment
) -> None:
    made = generator(checkpoint)
    np.testing.assert_array_equal(values(made, speech), values(made, speech, pieces=97))


def test_frames_are_final_after_a_bounded_delay(checkpoint: Path) -> None:
    speech, received, generated = spoken("a", 9.0), 0, 0
    lags = []

    def pieces() -> Iterator[Floats32]:
        nonlocal received
        for start in range(0, len(speech.audio.samples), 800):
            received = start + 800
            yield speech.audio.samples[start : start + 800]

    for part in generator(checkpoint).stream(pieces(), seed=1):
        lags.append(received / 16000 - generated / 15)
        generated += len(part)
    assert max(lags) <= 34 / 15 + 0.1 + 0.05


def test_windows_blend_into_each_other(checkpoint: Path) -> None:
    result = values(generator(checkpoint), spoken("a", 20.0))
    seams = Windows(frames=34, overlap=4, frame_rate=15.0)
    for part in (result[:, :27], result[:, 27:]):
        points = part.reshape(len(part), -1, 3)
        assert seam_acceleration(points, seams, of="points").value < 1.13


def test_motion_follows_the_chosen_speaker_and_ignores_the_seed_without_variation(
    checkpoint: Path, speech: SpeechSegment
) -> None:
    still = generator(checkpoint, variation=0.0)
    np.testing.assert_array_equal(values(still, speech), values(still, speech, seed=2))
    anna, ben = (
        values(generator(checkpoint, variation=0.0, speaker=name), speech) for name in ("anna", 2)
    )
    assert not np.array_equal(anna, ben)
    with pytest.raises(InputError, match="knows no speaker 'carl'"):
        values(generator(checkpoint, speaker="carl"), speech)


def test_the_clip_records_its_stand_ins(checkpoint: Path, speech: SpeechSegment) -> None:
    clip = generator(checkpoint).generate(speech, seed=1, frame_rate=30)
    assert len(clip) == 219
    assert clip.provenance["speaker"] in ("anna", "ben")
    assert "stand-in for FastText" in clip.provenance["stand_ins"]
    other = generator(checkpoint).generate(spoken("a", 7.3, 2), seed=1, frame_rate=30)
    assert "no words, as there is no transcript" in other.provenance["stand_ins"]
    assert not np.array_equal(clip.poses, other.poses)


def test_word_times_change_the_motion(
    checkpoint: Path, speech: SpeechSegment, tmp_path: Path
) -> None:
    (tmp_path / "a.csv").write_text(
        "word,start,end\nhello,3,4\nthere,4,5\nmy,5,5.5\nfriend,5.5,6\n"
    )
    made = generator(checkpoint, transcripts=tmp_path)
    clip = made.generate(speech, seed=1, frame_rate=15)
    plain = generator(checkpoint).generate(speech, seed=1, frame_rate=15)
    assert not np.array_equal(clip.poses, plain.poses)
    (tmp_path / "a.csv").write_text("word,start,end\nsomething,3,4\nelse,4,5\n")
    with pytest.raises(InputError, match=r"a\.csv.*has other words"):
        made.generate(speech, seed=1, frame_rate=15)
    (tmp_path / "a.csv").unlink()
    with pytest.raises(InputError, match="no transcript of a"):
        made.generate(speech, seed=1, frame_rate=15)


def test_mismatched_vectors_and_networks_are_refused(
    checkpoint: Path, speech: SpeechSegment, tmp_path: Path
) -> None:
    other = tmp_path / "other.vec"
    other.write_text("1 2\nhello 1 2\n")
    message = r"of width 300, but these vectors are other\.vec \(sha256 \w+\) of width 2"
    with pytest.raises(InputError, match=message):
        generator(checkpoint, vectors=other).generate(speech, seed=1, frame_rate=15)
    with pytest.raises(InputError, match="not of a Speech2UnifiedExpressions network"):
        values(generator(other_network(tmp_path / "other.safetensors")), speech)


@pytest.mark.parametrize(("left_out", "still"), [("faces", "arkit"), ("poses", "poses")])
def test_parts_that_a_network_does_not_generate_stay_still(
    tmp_path: Path, speech: SpeechSegment, left_out: str, still: str
) -> None:
    path = written_network(tmp_path / "a.safetensors", **{left_out: False})
    clip = generator(path).generate(speech, seed=1, frame_rate=15)
    assert np.ptp(getattr(clip, still), axis=0).max() < 1e-3
