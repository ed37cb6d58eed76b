"""Figures that stand still: single frames, strips of key words, overlaid variations."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from motion.audio import SPEECH_RATE
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import replacing
from renderer.figures.overlay import blended, colours_for, draw_overlay, faded
from renderer.figures.panels import FULL_BOX, Box, aspect_of, cropped, cut_out, panel
from renderer.figures.plate import DOTS_PER_INCH, check_ending
from renderer.figures.skeleton_lines import Place, joints_of, with_skeleton
from renderer.figures.strip import Moment, StripLayout, draw_strip
from renderer.shown_clip import frame_at
from studyapp.stimuli.figures.material import FigureMaterial, check_distinct
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class Choice:
    """What of a study a figure shows.

    Attributes
    ----------
    segment : str
        Name of the segment.
    conditions : tuple of str
        Each ``name`` or ``name=what it is called``; empty for all but the catch motion.
    moments : tuple of Moment
        From the segment's start.
    """

    segment: str
    conditions: tuple[str, ...] = ()
    moments: tuple[Moment, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Print:
    """How a figure is printed.

    Attributes
    ----------
    inches : float
        Width of the page.
    clear : bool
        Whether there is nothing behind the figures, rather than the videos' background.
    whole : bool
        Whether the whole picture is shown, rather than the part that a figure fills.
    closeup : bool
        Whether only the face is shown.
    outputs : tuple of Path
        Where to write; ``.pdf`` or ``.png``.
    """

    inches: float
    clear: bool
    whole: bool
    closeup: bool
    outputs: tuple[Path, ...]

    def __post_init__(self) -> None:
        for path in self.outputs:
            check_ending(path)


def write_still(
    folder: StudyFolder,
    *,
    segment: str,
    condition: str,
    seconds: float,
    size: int,
    skeleton: Place | None,
    clear: bool,
    closeup: bool,
    output: Path,
) -> None:
    """Write one frame of a condition as PNG.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    segment, condition : str
        Which clip.
    seconds : float
        Moment from the segment's start.
    size : int
        Pixels along each side.
    skeleton : {'over', 'beside'} or None
        Where the skeleton is drawn, if it is.
    clear : bool
        Whether there is nothing behind the figure.
    closeup : bool
        Whether only the face is shown.
    output : Path
        Where to write.
    """
    if output.suffix.lower() != ".png":
        raise InputError("a still is written as PNG", where=output, remedy="End its name with .png")
    material = FigureMaterial.of(folder)
    excerpt = material.segment(segment)
    pose = frame_at(material.clip(excerpt, condition), seconds)
    if closeup:
        material, [[pose]] = material.close_to_faces([[pose]])
    with material.stage(size) as stage:
        picture = panel(stage, pose, material.camera, clear=clear)
        if skeleton is not None:
            joints = joints_of(pose, stage.body)[0]
            picture = with_skeleton(picture, joints, material.camera, skeleton)
    with replacing(output) as draft:
        (picture if clear else picture.convert("RGB")).save(draft, "PNG", optimize=True)


def write_strip(
    folder: StudyFolder,
    choice: Choice,
    printed: Print,
    *,
    count: int,
    wave: bool,
    skeleton: bool,
) -> None:
    """Write a strip: a row for each condition, a column for each moment.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    choice : Choice
        What is shown.
    printed : Print
        How it is printed.
    count : int
        How many loud syllables to look for where `choice` has no moments.
    wave : bool
        Whether the speech's wave is drawn under it.
    skeleton : bool
        Whether the skeleton is drawn over the body.
    """
    material = FigureMaterial.of(folder)
    segment = material.segment(choice.segment)
    names = material.conditions(choice.conditions)
    moments = (
        material.moments(segment, choice.moments)
        if choice.moments
        else material.found_moments(segment, count)
    )
    clips = {called: material.clip(segment, name) for name, called in names.items()}
    rows = [[frame_at(clip, moment.seconds) for moment in moments] for clip in clips.values()]
    material, box, rows = _view(material, printed, rows)
    poses = {
        (called, moment): pose
        for called, row in zip(clips, rows, strict=True)
        for moment, pose in zip(moments, row, strict=True)
    }
    layout = StripLayout(
        inches=printed.inches,
        rows=tuple(clips),
        moments=moments,
        aspect=aspect_of(box),
        wave=wave,
        skeleton=skeleton,
    )
    with material.stage(_drawn_size(layout.panel[0], box)) as stage:
        panels = {
            key: cropped(
                panel(stage, pose, material.camera, clear=printed.clear, skeleton=skeleton),
                box,
                layout.panel,
            )
            for key, pose in poses.items()
        }
    speech = material.speech(segment, sample_rate=SPEECH_RATE)
    draw_strip(layout, panels, speech, clear=printed.clear).save(printed.outputs)


def write_overlay(
    folder: StudyFolder, choice: Choice, printed: Print, *, motions: Sequence[tuple[Path, str]]
) -> None:
    """Write an overlay of moments, or of variations at a moment, in one picture.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    choice : Choice
        Several conditions are variations of each other, several moments a trail.
    printed : Print
        How it is printed.
    motions : sequence of (Path, str)
        Motion files of the segment's speech that are variations too, such as other seeds, and
        what each is called.
    """
    material = FigureMaterial.of(folder)
    segment = material.segment(choice.segment)
    names = material.conditions(choice.conditions) if choice.conditions or not motions else {}
    check_distinct([*names.values(), *(called for _, called in motions)])
    colours_for(len(names) + len(motions))
    moments = material.moments(segment, choice.moments)
    clips = {called: material.clip(segment, name) for name, called in names.items()}
    clips |= {called: material.variation(segment, path) for path, called in motions}
    poses = [[frame_at(clip, moment.seconds) for moment in moments] for clip in clips.values()]
    material, box, poses = _view(material, printed, poses)
    width = round(printed.inches * DOTS_PER_INCH)
    with material.stage(_drawn_size(width, box)) as stage:
        trails = [
            faded([cut_out(stage, pose, material.camera).crop(box) for pose in row])
            for row in poses
        ]
    size = (width, round(width * aspect_of(box)))
    picture = blended(trails).picture.resize(size, Image.Resampling.LANCZOS)
    caption = " → ".join(moment.label for moment in moments)
    background = material.plan.look.background
    page = draw_overlay(picture, list(clips), caption, clear=printed.clear, background=background)
    page.save(printed.outputs)


def _view(
    material: FigureMaterial, printed: Print, rows: list[list[MotionClip]]
) -> tuple[FigureMaterial, Box, list[list[MotionClip]]]:
    """Return the material seen as asked for, the part of its picture that is shown, and poses."""
    if printed.closeup:
        material, rows = material.close_to_faces(rows)
        return material, FULL_BOX, rows
    everyone = [pose for row in rows for pose in row]
    return material, FULL_BOX if printed.whole else material.box_around(everyone), rows


def _drawn_size(width: int, box: Box) -> int:
    """Return the pixels along a whole picture whose part `box` is `width` wide."""
    return math.ceil(width / (box[2] - box[0]))
