"""Previews of motion files without a study, and exports for other programs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio, read_audio, write_wav
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import replacing
from motion.formats import read_recorded
from motion.formats.bvh_motion import write_clip_bvh
from motion.formats.glb import write_glb
from motion.formats.joint_maps import JointMap
from motion.placement import stand_on_ground
from motion.resample import cut
from renderer.clip_video import Stage
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.framing import frame_clips
from renderer.look import Look, default_body
from renderer.loudness import at_common_loudness
from renderer.shown_clip import LENGTH_TOLERANCE, as_shown
from renderer.viewer.page import MAX_CLIPS, Scene, write_motion_page

PAGE, VIDEO, GLB, BVH = KINDS = ("page", "video", "glb", "bvh")
"""One page of all motion files; or a video, a GLB or a BVH of each."""

_PAGE_OF_SEVERAL: Final = "motions.html"


@dataclass(frozen=True, kw_only=True)
class PreviewedMotion:
    """A motion file to preview.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        Its label, and the name of exported files.
    clip : MotionClip
        Its motion, cut to the speech.
    speech : Audio or None
        The speech, as long as the motion.
    notes : tuple of str
        Changes made while reading.
    """

    path: Path
    name: str
    clip: MotionClip
    speech: Audio | None
    notes: tuple[str, ...]


def distinct_names(paths: Sequence[Path]) -> list[str]:
    """Return distinct names of motion files, with their folders' names if needed."""
    names = [path.stem for path in paths]
    if len(set(names)) < len(names):
        names = [f"{path.absolute().parent.name}-{path.stem}" for path in paths]
    repeated = {name for name in names if names.count(name) > 1}
    return [f"{name}-{k}" if name in repeated else name for k, name in enumerate(names, start=1)]


def read_previewed(
    path: Path,
    name: str,
    *,
    speech: Path | None = None,
    frame_rate: float | None = None,
    joint_map: JointMap | None = None,
) -> PreviewedMotion:
    """Read a motion file and its speech.

    Parameters
    ----------
    path : Path
        In any format that `motion.formats.read_motion` reads.
    name : str
        Its name.
    speech : Path, optional
        The speech; the longer of the two is cut.
    frame_rate : float, optional
        Overrides the file's frame rate.
    joint_map : mapping of str to str, optional
        For a BVH of an unknown skeleton.

    Raises
    ------
    InputError
        If motion or speech cannot be read.
    """
    clip, notes = read_recorded(path, frame_rate=frame_rate, joint_map=joint_map)
    audio = None
    if speech is not None:
        audio = read_audio(speech, sample_rate=SOUND_RATE)
        seconds = min(audio.duration, clip.duration)
        if abs(audio.duration - clip.duration) > LENGTH_TOLERANCE:
            lengths = f"the motion lasts {clip.duration:.2f} s, the speech {audio.duration:.2f} s"
            notes = [*notes, f"{path.name}: {lengths}; cut to the common {seconds:.2f} s"]
        audio, clip = at_common_loudness(audio.cut(0.0, seconds)), cut(clip, 0.0, seconds)
    return PreviewedMotion(path=path, name=name, clip=clip, speech=audio, notes=tuple(notes))


def write_preview_page(motions: Sequence[PreviewedMotion], out: Path, look: Look) -> Path:
    """Write a page on which all motions can be played in sync and turned around; return it.

    Parameters
    ----------
    motions : sequence of PreviewedMotion
        At least one; all have the same speech, if any. The page shows `MAX_CLIPS` in a row.
    out : Path
        The output folder.
    look : Look
        Body and framing.
    """
    body = read_body(default_body(look.avatar))
    clips = {
        motion.name: as_shown(
            motion.clip, body, motion.path, motion.clip.duration, (), look.frame_rate
        )
        for motion in motions
    }
    rows = [motions[start : start + MAX_CLIPS] for start in range(0, len(motions), MAX_CLIPS)]
    page = out / (f"{motions[0].name}.html" if len(motions) == 1 else _PAGE_OF_SEVERAL)
    write_motion_page(
        page,
        ", ".join(clips),
        [
            Scene(
                name=", ".join(motion.name for motion in row),
                clips={motion.name: clips[motion.name] for motion in row},
                speech=max(
                    (motion.speech for motion in row if motion.speech),
                    default=None,
                    key=lambda speech: speech.duration,
                ),
            )
            for row in rows
        ],
        look,
    )
    return page


def write_preview(
    motion: PreviewedMotion, kind: str, out: Path, look: Look, on_step: Callable[[str], None]
) -> tuple[Path, ...]:
    """Write a motion as one of `KINDS`, named after its file; return the written files.

    Parameters
    ----------
    motion : PreviewedMotion
        The motion.
    kind : str
        ``video``: as in a study, with a camera for this motion. ``glb`` and ``bvh``: for other
        programs, on the ground at height 0, with the speech in a separate file.
    out : Path
        The output folder.
    look : Look
        Body, size and framing.
    on_step : callable
        Called with the name of the next step, and with each frame of a video.
    """
    if kind == VIDEO:
        return _write_video(motion, out, look, on_step)
    target = out / f"{motion.name}.{kind}"
    on_step(f"writing {target.name}")
    if target.exists() and target.samefile(motion.path):
        raise InputError(
            f"this {kind.upper()} would overwrite its own source",
            where=motion.path,
            remedy="Choose another folder (--out)",
        )
    body = read_body(default_body(look.avatar))
    joints = body.joints(motion.clip.betas)
    clip = stand_on_ground(motion.clip, joints)
    ground = np.array([0, body.shaped(clip.betas)[:, 1].min(), 0], np.float32)
    clip = replace(clip, trans=clip.trans - ground)
    files = [target]
    if motion.speech is not None:
        files.append(out / f"{motion.name}-speech.wav")
        write_wav(files[-1], motion.speech)
    if kind == GLB:
        write_glb(target, clip, body, speech=files[-1].name if motion.speech else "")
    else:
        write_clip_bvh(target, clip, joints)
    return tuple(files)


def _write_video(
    motion: PreviewedMotion, out: Path, look: Look, on_step: Callable[[str], None]
) -> tuple[Path]:
    clip, body = motion.clip, default_body(look.avatar)
    model = read_body(body)
    silence = Audio(np.zeros(round(clip.duration * SOUND_RATE), np.float32), SOUND_RATE)
    shown = as_shown(clip, model, motion.path, clip.duration, (), look.frame_rate)
    video = out / f"{motion.name}.mp4"
    with (
        Stage(body, frame_clips([shown], model, look), look) as stage,
        replacing(video) as draft,
        VideoWriter(
            draft, look.size, look.size, look.frame_rate, motion.speech or silence
        ) as writer,
    ):
        for number, frame in enumerate(stage.video_frames(shown), start=1):
            on_step(f"writing {video.name}, frame {number} of {len(shown)}")
            writer.write(frame)
    return (video,)
