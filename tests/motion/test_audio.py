from collections.abc import Callable
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
from tests.support.sounds import tone


def encode(path: Path, samples: np.ndarray, rate: int, codec: str, container: str) -> Path:
    options = {"movflags": "faststart"} if container == "mp4" else {}
    with av.open(str(path), "w", format=container, options=options) as output:
        stream = output.add_stream(codec, rate=rate, layout="mono")
        assert isinstance(stream, AudioStream)
        frame = av.AudioFrame.from_ndarray(samples[None], format="fltp", layout="mono")
        frame.sample_rate = rate
        for packet in [*stream.encode(frame), *stream.encode(None)]:
            output.mux(packet)
    return path


def test_pcm_survives_a_round_trip_within_one_step(tmp_path: Path) -> None:
    audio = tone(1)
    write_wav(tmp_path / "a.wav", audio)
    read = read_audio(tmp_path / "a.wav")
    assert (read.sample_rate, read.notes) == (16000, ())
    np.testing.assert_allclose(read.samples, audio.samples, atol=1 / 32768)
    assert soundfile.info(tmp_path / "a.wav").subtype == "PCM_16"


@pytest.mark.parametrize(
    ("codec", "container", "rate"),
    [("mp3", "mp3", 44100), ("aac", "mp4", 48000), ("flac", "flac", 22050), ("opus", "ogg", 48000)],
)
def test_the_format_follows_the_content_not_the_extension(
    tmp_path: Path, codec: str, container: str, rate: int
) -> None:
    samples = tone(2, rate=rate).samples
    if container == "flac":
        soundfile.write(tmp_path / "a.wav", samples, rate, format="FLAC")
    else:
        name = {"opus": "libopus"}.get(codec, codec)
        encode(tmp_path / "a.wav", samples, rate, name, container)
    audio = read_audio(tmp_path / "a.wav")
    assert audio.sample_rate == 16000
    assert audio.duration == pytest.approx(2.0, abs=0.06)
    (note,) = audio.notes
    assert "a.wav is really" in note
    middle = audio.samples[8000:24000] * np.hanning(16000)
    assert np.abs(np.fft.rfft(middle)).argmax() == pytest.approx(440, abs=1)


@given(
    rate=st.sampled_from([8000, 11025, 22050, 44100, 48000]),
    seconds=st.floats(min_value=0.2, max_value=2),
)
def test_resampling_is_optional_and_keeps_the_duration(
    tmp_path_factory: pytest.TempPathFactory, rate: int, seconds: float
) -> None:
    path = tmp_path_factory.mktemp("audio") / "a.wav"
    soundfile.write(path, tone(seconds, rate=rate).samples, rate)
    count = round(seconds * rate)
    assert read_audio(path).duration == pytest.approx(count / rate, abs=2 / 16000)
    unchanged = read_audio(path, sample_rate=None)
    assert (unchanged.sample_rate, len(unchanged.samples)) == (rate, count)


@pytest.mark.parametrize("count", [2, 8, 12])
def test_channels_are_averaged(tmp_path: Path, count: int) -> None:
    channels = np.tile(np.linspace(0.2, 0.8, count), (16000, 1))
    soundfile.write(tmp_path / "a.wav", channels, 16000, subtype="FLOAT")
    np.testing.assert_allclose(read_audio(tmp_path / "a.wav").samples, 0.5, atol=1e-6)


def test_clipping_levels_are_scaled_down_with_a_note(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "a.wav", 4 * tone(1).samples, 16000, subtype="FLOAT")
    audio = read_audio(tmp_path / "a.wav")
    assert np.abs(audio.samples).max() == pytest.approx(1)
    assert "2.00 of full scale" in audio.notes[0]


def half_of_a_sound(path: Path) -> None:
    if path.suffix == ".m4a":
        encode(path, tone(8, rate=48000).samples, 48000, "aac", "mp4")
    else:
        soundfile.write(path, np.random.default_rng(0).uniform(-0.5, 0.5, 32000), 16000)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def sound_with_a_gap(path: Path) -> None:
    soundfile.write(path, np.append(tone(1).samples, np.inf), 16000, subtype="FLOAT")


@pytest.mark.parametrize(
    ("name", "write", "complaint"),
    [
        ("half.wav", half_of_a_sound, "the file is truncated.*Copy or export"),
        ("half.flac", half_of_a_sound, "the file is damaged"),
        ("half.m4a", half_of_a_sound, "the file is damaged"),
        ("gap.wav", sound_with_a_gap, "not a number"),
        ("empty.wav", Path.touch, "the file is damaged"),
        ("words.wav", lambda path: path.write_text("words " * 99), "cannot be read as audio"),
        ("start.wav", lambda path: path.write_bytes(b"RIFF\x24\x00\x00\x00WAVEfmt "), "audio"),
        ("bytes.wav", lambda path: path.write_bytes(bytes(range(256)) * 20), "audio"),
        ("gone.wav", lambda path: None, "no such audio file"),
        ("folder.wav", Path.mkdir, "no such audio file"),
    ],
)
def test_a_file_without_usable_sound_is_refused_by_name(
    tmp_path: Path, name: str, write: Callable[[Path], object], complaint: str
) -> None:
    write(tmp_path / name)
    with pytest.raises(InputError, match=rf"{name}: .*{complaint}") as caught:
        read_audio(tmp_path / name)
    assert caught.value.remedy


def test_a_recording_that_decodes_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A header may claim one sample a second, which resampling would blow up 16000 times.
    assert LONGEST == 3 * 3600
    monkeypatch.setattr("motion.audio.LONGEST", 3600)
    soundfile.write(tmp_path / "slow.wav", np.zeros(3600 + 8192, np.int16), 1)
    with pytest.raises(InputError, match=r"slow\.wav: the recording lasts longer than 1 hours"):
        read_audio(tmp_path / "slow.wav")


def test_playlists_are_not_followed(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "private.wav", np.zeros(8192, np.int16), 16_000)
    (tmp_path / "list.wav").write_text("ffconcat version 1.0\nfile private.wav\n", "utf-8")
    with pytest.raises(InputError, match=r"list\.wav: the file .* cannot be read as audio"):
        read_audio(tmp_path / "list.wav")


def test_a_cut_starts_exactly_and_pads_a_short_end_with_silence() -> None:
    audio = tone(1)
    cut = audio.cut(0.5, 1.05)
    assert len(cut.samples) == 8800
    np.testing.assert_array_equal(cut.samples[:8000], audio.samples[8000:])
    assert not cut.samples[8000:].any()


@pytest.mark.parametrize("samples", [np.zeros(0), np.zeros((2, 9))])
def test_unusable_samples_are_refused(samples: np.ndarray) -> None:
    with pytest.raises(InputError):
        Audio(samples, 16000)
