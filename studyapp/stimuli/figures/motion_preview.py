"""Looking at motion files without a study, and exporting them for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio, read_audio, write_wav
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import replacing
from motion.formats.clip_bvh import write_clip_bvh
from motion.formats.glb import write_glb
from motion.formats.joint_maps import JointMap
from motion.placement import stand_on_ground
from motion.resample import cut
from renderer.clip_video import Stage
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.framing import frame_clips
from renderer.look import Look, default_body
from renderer.loudness import at_common_loudness
from renderer.shown_clip import as_shown
from renderer.viewer.page import MAX_CLIPS, Scene, write_motion_page
from studyapp.stimuli.recorded_beside import read_recorded

PAGE, VIDEO, GLB, BVH = KINDS = ("page", "video", "glb", "bvh")
"""What can be written: one page of all motion files, or of each a video, a GLB or a BVH."""

_PAGE_OF_SEVERAL: Final = "motions.html"


@dataclass(frozen=True, kw_only=True)
class PreviewedMotion:
    """A motion file as it was read.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        What it is called, and files that are made of it.
    clip : MotionClip
        Its motion, cut to the speech where there is any.
    speech : Audio or None
        What is heard, as long as the motion.
    notes : tuple of str
        What was changed on the way.
    """

    path: Path
    name: str
    clip: MotionClip
    speech: Audio | None
    notes: tuple[str, ...]


def distinct_names(paths: Sequence[Path]) -> list[str]:
    """Return what motion files are called: their own names, with their folders' where needed."""
    names = [path.stem for path in paths]
    if len(set(names)) < len(names):
        names = [f"{path.absolute().parent.name}-{path.stem}" for path in paths]
    twice = {name for name in names if names.count(name) > 1}
    return [f"{name}-{k}" if name in twice else name for k, name in enumerate(names, start=1)]


def read_previewed(
    path: Path,
    name: str,
    *,
    speech: Path | None = None,
    frame_rate: float | None = None,
    joint_map: JointMap | None = None,
) -> PreviewedMotion:
    """Read a motion file and what is heard with it.

    Parameters
    ----------
    path : Path
        In any format that `motion.formats.read_motion` reads.
    name : str
        What it is called.
    speech : Path, optional
        What is heard; where one of the two is longer, it is cut.
    frame_rate : float, optional
        Overrides what the file says of its frame rate.
    joint_map : mapping of str to str, optional
        For a BVH of an unknown skeleton.

    Raises
    ------
    InputError
        If motion or speech cannot be read.
    """
    clip, notes = read_recorded(path, frame_rate=frame_rate, joint_map=joint_map)
    heard = None
    if speech is not None:
        heard = read_audio(speech, sample_rate=SOUND_RATE)
        seconds = min(heard.duration, clip.duration)
        heard, clip = at_common_loudness(heard.cut(0.0, seconds)), cut(clip, 0.0, seconds)
    return PreviewedMotion(path=path, name=name, clip=clip, speech=heard, notes=tuple(notes))


def write_preview_page(motions: Sequence[PreviewedMotion], out: Path, look: Look) -> Path:
    """Write one page on which all motions can be played and turned around, and return it.

    They stand side by side on one clock, `MAX_CLIPS` in a row.

    Parameters
    ----------
    motions : sequence of PreviewedMotion
        At least one; all have the same speech, if any.
    out : Path
        The folder.
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
                    (motion.speech for motion in row if motion.speech), default=None, key=_length
                ),
            )
            for row in rows
        ],
        look,
    )
    return page


def _length(speech: Audio) -> float:
    return speech.duration


def write_preview(motion: PreviewedMotion, kind: str, out: Path, look: Look) -> tuple[Path, ...]:
    """Write a motion as one of `KINDS`, named after its file, and return what was written.

    Parameters
    ----------
    motion : PreviewedMotion
        The motion.
    kind : str
        ``video``: as a study would show it, by a camera that fits this motion.
        ``glb`` and ``bvh``: for other programs, on the ground at height 0; the speech
        lies beside.
    out : Path
        The folder.
    look : Look
        Body, size and framing.
    """
    if kind == VIDEO:
        return _write_video(motion, out, look)
    target = out / f"{motion.name}.{kind}"
    if target.exists() and target.samefile(motion.path):
        raise InputError(
            f"this {kind.upper()} would replace the motion that it is made of",
            where=motion.path,
            remedy="Name another folder with --out",
        )
    body = read_body(default_body(look.avatar))
    joints = body.joints(motion.clip.betas)
    clip = stand_on_ground(motion.clip, joints)
    ground = np.array([0, body.shaped(clip.betas)[:, 1].min(), 0], np.float32)
    clip = replace(clip, trans=clip.trans - ground)
    beside: tuple[Path, ...] = ()
    if motion.speech is not None:
        beside = (out / f"{motion.name}-speech.wav",)
        write_wav(beside[0], motion.speech)
    if kind == GLB:
        write_glb(target, clip, body, speech=beside[0].name if beside else "")
    else:
        write_clip_bvh(target, clip, joints)
    return (target, *beside)


def _write_video(motion: PreviewedMotion, out: Path, look: Look) -> tuple[Path]:
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
        for frame in stage.video_frames(shown):
            writer.write(frame)
    return (video,)
