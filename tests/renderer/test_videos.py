from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from av.audio.stream import AudioStream
from av.video.stream import VideoStream

from motion.audio import Audio
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.placement import ground_height, sole_heights
from motion.skeleton import joint_index
from renderer.clip_video import Stage, write_clip_video
from renderer.jobs.doing import Stages
from renderer.look import Look
from renderer.loudness import TARGET, integrated_loudness
from renderer.pair import write_pair
from renderer.shown_clip import as_shown, frame_at
from renderer.video_jobs import ClipJob
from tests.motion.random_clips import clip_of
from tests.renderer.conftest import SECONDS
from tests.renderer.golden_frames import assert_like_golden
from tests.renderer.jobs.sample_jobs import pair_of
from tests.support.encoded import pictures_of, sound_of

FRAMES = round(SECONDS * 30)


@dataclass(frozen=True)
class Studio:
    """Renders the test clip with part of its speech, and pairs of it."""

    stage: Stage
    job: ClipJob

    def render(self, out: Path, **changes: Any) -> tuple[Path, Path]:
        """Render the test clip to `out`, and return its video and its frames."""
        video, frames = out / "clip.mp4", out / "clip.mkv"
        write_clip_video(replace(self.job, frames=frames, video=video, **changes), self.stage)
        return video, frames

    def compose(self, left: Path, right: Path, video: Path, **changes: Any) -> Path:
        """Compose frames side by side, and return the video."""
        clip = replace(self.job, frames=left, video=video)
        write_pair(replace(pair_of(clip, "pair"), right=right, video=video, **changes))
        return video


@contextmanager
def opened(job: ClipJob) -> Iterator[Studio]:
    """Open a studio for a later part of the speech of `job`."""
    with Stages() as stages:
        yield Studio(stages.stage_for(job), replace(job, start=0.25, end=0.25 + SECONDS))


@pytest.fixture(scope="module")
def studio(job: ClipJob) -> Iterator[Studio]:
    with opened(job) as studio:
        yield studio


@pytest.fixture(scope="module")
def rendered(studio: Studio, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return studio.render(tmp_path_factory.mktemp("clip"))


@pytest.fixture(scope="module")
def moving(rendered: tuple[Path, Path]) -> Path:
    """Return the frames of the clip."""
    return rendered[1]


@pytest.fixture(scope="module")
def still(studio: Studio, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the frames of the clip when much of it is frozen."""
    frozen = ("face", "hands", "lower_body", "root")
    return studio.render(tmp_path_factory.mktemp("still"), freeze=frozen)[1]


@pytest.fixture(scope="module")
def pair(
    studio: Studio, moving: Path, still: Path, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    return studio.compose(moving, still, tmp_path_factory.mktemp("pair") / "pair.mp4")


@pytest.fixture(params=["clip", "pair"])
def video(request: pytest.FixtureRequest, rendered: tuple[Path, Path], pair: Path) -> Path:
    return rendered[0] if request.param == "clip" else pair


def lasting(stream: VideoStream | AudioStream) -> Fraction:
    """Return the declared duration of a stream in seconds."""
    assert stream.duration is not None
    assert stream.time_base is not None
    return stream.duration * stream.time_base


def test_a_video_has_exactly_its_speechs_frames_and_colour_tags(video: Path) -> None:
    with av.open(str(video)) as container:
        stream = container.streams.video[0]
        assert stream.average_rate == 30
        assert sum(1 for _ in container.decode(stream)) == FRAMES
        assert lasting(stream) == Fraction(FRAMES, 30)
        context = stream.codec_context
        assert context.pix_fmt == "yuv420p"
        # BT.709, and levels from 16 to 235
        assert (context.color_primaries, context.color_trc, context.colorspace) == (1, 1, 1)
        assert context.color_range == 1


def test_sound_lasts_as_long_as_the_picture_and_starts_with_it(video: Path) -> None:
    with av.open(str(video)) as container:
        stream = container.streams.audio[0]
        assert (stream.codec_context.name, stream.rate) == ("aac", 48000)
        assert float(lasting(stream)) == pytest.approx(SECONDS, abs=1024 / 48000)
    sound = sound_of(video)
    loud = np.flatnonzero(np.abs(sound) > 0.05)
    assert loud[0] < 0.03 * 48000
    assert integrated_loudness(Audio(sound, 48000)) == pytest.approx(TARGET, abs=0.3)


def test_a_video_plays_while_loading_and_contains_no_names(video: Path, inputs: Path) -> None:
    with av.open(str(video)) as container:
        facts = dict(container.metadata)
        for stream in container.streams:
            facts |= stream.metadata
    assert set(facts) <= {
        "major_brand", "minor_version", "compatible_brands", "language", "handler_name",
        "vendor_id",
    }  # fmt: skip
    assert facts["handler_name"] in ("VideoHandler", "SoundHandler")
    data = video.read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")
    for name in (b"clip", b"speech", inputs.name.encode(), b"Lavf"):
        assert name not in data


def test_the_same_input_gives_the_same_bytes(
    rendered: tuple[Path, Path], studio: Studio, tmp_path: Path
) -> None:
    for first, second in zip(rendered, studio.render(tmp_path), strict=True):
        assert first.read_bytes() == second.read_bytes()


def test_frames_are_kept_without_loss(moving: Path, studio: Studio) -> None:
    clip = read_clip(studio.job.motion)
    expected = [frame.to_ndarray() for frame in studio.stage.video_frames(clip)]
    with av.open(str(moving)) as container:
        decoded = [frame.to_ndarray() for frame in container.decode(video=0)]
    np.testing.assert_array_equal(decoded, expected)


def test_motion_much_shorter_than_its_speech_is_refused_without_a_file(
    studio: Studio, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"0\.80 s, its speech 1\.40 s"):
        studio.render(tmp_path, end=1.65)
    assert list(tmp_path.iterdir()) == []


def test_labels_are_the_same_in_both_orders(
    pair: Path, moving: Path, still: Path, studio: Studio, tmp_path: Path
) -> None:
    swapped = studio.compose(still, moving, tmp_path / "other.mp4")
    one, other = (pictures_of(video)[0].astype(int) for video in (pair, swapped))
    for corner in (np.s_[:20, :20], np.s_[:20, 160:180]):
        assert np.abs(one[corner] - other[corner]).max() <= 6
        assert one[corner].min() < 120
    assert np.abs(one[:20, :20] - one[:20, 160:180]).max() > 60


def test_a_pair_matches_its_golden_picture(pair: Path, tmp_path: Path) -> None:
    assert_like_golden(pictures_of(pair)[12], "pair", tmp_path)


def test_a_pair_on_a_dark_background_matches_its_golden_picture(
    job: ClipJob, tmp_path: Path
) -> None:
    dark = replace(job.look, background=(0x2E, 0x34, 0x40))
    with opened(replace(job, look=dark)) as studio:
        _, frames = studio.render(tmp_path)
    pair = studio.compose(frames, frames, tmp_path / "pair.mp4")
    assert_like_golden(pictures_of(pair)[0], "pair-on-dark", tmp_path)


def test_missing_or_broken_frames_are_refused_without_a_partial_file(
    studio: Studio, moving: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="have 24 common frames, but 27 are needed"):
        studio.compose(moving, moving, tmp_path / "pair.mp4", end=0.25 + 0.9)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match="missing"):
        studio.compose(moving, tmp_path / "no.mkv", tmp_path / "pair.mp4")
    (tmp_path / "bad.mkv").write_bytes(b"not a video" * 50)
    with pytest.raises(InputError, match="cannot be read"):
        studio.compose(moving, tmp_path / "bad.mkv", tmp_path / "pair.mp4")
    with pytest.raises(InputError, match="160 × 160, expected 320 × 320"):
        studio.compose(moving, moving, tmp_path / "pair.mp4", look=Look(size=320))


def test_the_pipeline_runs_at_a_fractional_frame_rate(job: ClipJob, tmp_path: Path) -> None:
    with opened(replace(job, look=Look(size=64, frame_rate=25))) as studio:
        video, _ = studio.render(tmp_path)
    with av.open(str(video)) as container:
        assert container.streams.video[0].average_rate == 25
        assert sum(1 for _ in container.decode(video=0)) == 20


def test_feet_of_motion_whose_height_is_unknown_stay_on_the_ground(body: BodyModel) -> None:
    poses = np.zeros((30, 55, 3))
    for side in ("left", "right"):
        for joint, angle in (("hip", -0.8), ("knee", 1.6), ("ankle", -0.8)):
            poses[:, joint_index(f"{side}_{joint}"), 0] = angle * np.linspace(0.5, 1, 30)
    joints = body.joints(np.zeros(0))
    shown = as_shown(clip_of(poses), body, Path("a.npz"), 1.0, (), 30)
    np.testing.assert_allclose(sole_heights(shown, joints), ground_height(joints), atol=0.02)


def test_past_the_end_of_a_motion_there_is_no_frame_to_show(clip: MotionClip) -> None:
    with pytest.raises(InputError, match=r"no frame at 0\.9 s of a motion of 0\.80 s"):
        frame_at(clip, 0.9)
