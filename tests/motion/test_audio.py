from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest
import soundfile
from av.audio.stream import AudioStream
from hypothesis import given
from hypothesis import strategies as st

from motion.audio import LONGEST, Audio, read_audio, write_wav
from motion.errors import InputError


def tone(seconds: float = 1.0, rate: int = 16000, hertz: float = 440.0) -> np.ndarray:
    return (0.5 * np.sin(2 * np.pi * hertz * np.arange(round(seconds * rate)) / rate)).astype(
        np.float32
    )


def encode(
    path: Path,
    samples: np.ndarray,
    rate: int,
    codec: str,
    container: str,
    options: dict[str, str] | None = None,
) -> Path:
    with av.open(str(path), "w", format=container, options=options or {}) as output:
        stream = output.add_stream(codec, rate=rate, layout="mono")
        assert isinstance(stream, AudioStream)
        frame = av.AudioFrame.from_ndarray(samples[None], format="fltp", layout="mono")
        frame.sample_rate = rate
        for packet in [*stream.encode(frame), *stream.encode(None)]:
            output.mux(packet)
    return path


def test_pcm_written_is_read_back_within_one_step(tmp_path: Path) -> None:
    audio = Audio(tone(), 16000)
    write_wav(tmp_path / "a.wav", audio)
    read = read_audio(tmp_path / "a.wav")
    assert read.sample_rate == 16000
    assert read.notes == ()
    np.testing.assert_allclose(read.samples, audio.samples, atol=1 / 32768)
    assert soundfile.info(tmp_path / "a.wav").subtype == "PCM_16"
    assert [file.name for file in tmp_path.iterdir()] == ["a.wav"]


@pytest.mark.parametrize(
    ("codec", "container", "rate"),
    [("mp3", "mp3", 44100), ("aac", "mp4", 48000), ("flac", "flac", 22050), ("opus", "ogg", 48000)],
)
def test_content_decides_the_format_not_the_ending(
    tmp_path: Path, codec: str, container: str, rate: int
) -> None:
    samples = tone(2.0, rate)
    if container == "flac":
        soundfile.write(tmp_path / "a.wav", samples, rate, format="FLAC")
    else:
        name = {"opus": "libopus"}.get(codec, codec)
        encode(tmp_path / "a.wav", samples, rate, name, container)
    audio = read_audio(tmp_path / "a.wav")
    assert audio.sample_rate == 16000
    assert audio.duration == pytest.approx(2.0, abs=0.06)
    assert len(audio.notes) == 1
    assert "a.wav is really" in audio.notes[0]
    middle = audio.samples[8000:24000] * np.hanning(16000)
    assert np.abs(np.fft.rfft(middle)).argmax() == pytest.approx(440, abs=1)


@given(
    rate=st.sampled_from([8000, 11025, 22050, 44100, 48000]),
    seconds=st.floats(min_value=0.2, max_value=2),
)
def test_resampling_keeps_the_duration(
    tmp_path_factory: pytest.TempPathFactory, rate: int, seconds: float
) -> None:
    path = tmp_path_factory.mktemp("audio") / "a.wav"
    soundfile.write(path, tone(seconds, rate), rate)
    audio = read_audio(path)
    assert audio.duration == pytest.approx(round(seconds * rate) / rate, abs=2 / 16000)


def test_own_rate_is_kept_on_request(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "a.wav", tone(1.0, 22050), 22050)
    audio = read_audio(tmp_path / "a.wav", sample_rate=None)
    assert (audio.sample_rate, len(audio.samples)) == (22050, 22050)


def test_channels_are_averaged(tmp_path: Path) -> None:
    stereo = np.stack([np.full(16000, 0.8), np.full(16000, 0.2)], axis=1)
    soundfile.write(tmp_path / "a.wav", stereo, 16000, subtype="FLOAT")
    np.testing.assert_allclose(read_audio(tmp_path / "a.wav").samples, 0.5, atol=1e-6)


def test_a_level_above_full_scale_is_scaled_down_with_a_note(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "a.wav", 4 * tone(), 16000, subtype="FLOAT")
    audio = read_audio(tmp_path / "a.wav")
    assert np.abs(audio.samples).max() == pytest.approx(1)
    assert "2.00 of full scale" in audio.notes[0]


@pytest.mark.parametrize(
    ("ending", "complaint"),
    [
        ("wav", "the file is truncated.*Copy or export"),
        ("flac", "the file is damaged"),
        ("m4a", "the file is damaged"),
    ],
)
def test_truncated_files_are_refused_by_name(tmp_path: Path, ending: str, complaint: str) -> None:
    path = tmp_path / f"half.{ending}"
    if ending == "m4a":
        encode(path, tone(8.0, 48000), 48000, "aac", "mp4", {"movflags": "faststart"})
    else:
        soundfile.write(path, np.random.default_rng(0).uniform(-0.5, 0.5, 32000), 16000)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match=rf"half\.{ending}: {complaint}"):
        read_audio(path)


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "the file is empty"),
        (b"these are words, not sound. " * 99, "cannot be read as audio"),
        (b"RIFF\x24\x00\x00\x00WAVEfmt ", "cannot be read as audio|no sample|no audio stream"),
        (bytes(range(256)) * 20, "cannot be read as audio|no audio stream"),
    ],
)
def test_files_without_audio_are_refused_by_name(
    tmp_path: Path, content: bytes, complaint: str
) -> None:
    path = tmp_path / "odd.wav"
    path.write_bytes(content)
    with pytest.raises(InputError, match=complaint) as caught:
        read_audio(path)
    assert str(path) in str(caught.value)
    assert caught.value.remedy


def test_not_a_number_in_float_wav_is_refused_by_name(tmp_path: Path) -> None:
    samples = tone()
    samples[99] = np.nan
    soundfile.write(tmp_path / "nan.wav", samples, 16000, subtype="FLOAT")
    with pytest.raises(InputError, match=r"nan\.wav.*not a number"):
        read_audio(tmp_path / "nan.wav")


def test_recording_that_unpacks_to_more_than_a_study_needs_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A header may claim one sample a second, which resampling would blow up 16000 times.
    assert LONGEST == 3 * 3600
    monkeypatch.setattr("motion.audio.LONGEST", 3600)
    soundfile.write(tmp_path / "slow.wav", np.zeros(3600 + 8192, np.int16), 1)
    with pytest.raises(InputError, match=r"slow\.wav: the recording lasts longer than 1 hours"):
        read_audio(tmp_path / "slow.wav")


def test_a_list_of_other_files_is_not_followed(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "private.wav", np.zeros(8192, np.int16), 16_000)
    (tmp_path / "list.wav").write_text("ffconcat version 1.0\nfile private.wav\n", "utf-8")
    with pytest.raises(InputError, match=r"list\.wav: the file .* cannot be read as audio"):
        read_audio(tmp_path / "list.wav")


@pytest.mark.parametrize("path", ["gone.wav", "."])
def test_missing_file_is_named(tmp_path: Path, path: str) -> None:
    with pytest.raises(InputError, match="no such audio file"):
        read_audio(tmp_path / path)


@given(start=st.floats(0, 0.9), length=st.floats(0.01, 1))
def test_cut_has_exactly_the_samples_asked_for(start: float, length: float) -> None:
    audio = Audio(tone(2.0), 16000)
    cut = audio.cut(start, start + length)
    assert len(cut.samples) == round((start + length - start) * 16000)
    first = round(start * 16000)
    np.testing.assert_array_equal(cut.samples, audio.samples[first : first + len(cut.samples)])


def test_cut_pads_a_short_end_with_silence_and_refuses_more() -> None:
    cut = Audio(tone(1.0), 16000).cut(0.5, 1.05)
    assert len(cut.samples) == 8800
    assert not cut.samples[8000:].any()
    with pytest.raises(InputError, match="excerpt"):
        Audio(tone(1.0), 16000).cut(0.5, 1.2)


@pytest.mark.parametrize(
    ("samples", "rate"), [(np.zeros(0), 16000), (np.zeros((2, 9)), 16000), (np.zeros(9), 0)]
)
def test_unusable_samples_are_refused(samples: np.ndarray, rate: int) -> None:
    with pytest.raises(InputError):
        Audio(samples, rate)
