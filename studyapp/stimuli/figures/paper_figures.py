"""Figures of a paper: frames, strips of key words, overlaid variations, and grids of videos."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from PIL import Image

from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import replacing
from renderer.encoder import SOUND_RATE
from renderer.figures.grid_video import GridLayout, write_grid
from renderer.figures.overlay import blended, colours_for, draw_overlay, faded
from renderer.figures.panels import FULL_BOX, Box, aspect_of, common_box, cropped, cut_out, panel
from renderer.figures.plate import DOTS_PER_INCH, check_ending
from renderer.figures.strip import Moment, StripLayout, draw_strip, loud_moments
from renderer.shown_clip import frame_at
from studyapp.stimuli.figures.material import FigureMaterial
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class PaperFigure:
    """The content of a figure, and how it is printed.

    Attributes
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    segment : str
        Name of the segment.
    conditions : tuple of str
        Each ``name`` or ``name=label``; empty for all but the catch condition.
    moments : tuple of Moment
        Measured from the segment's start.
    inches : float
        Width in print.
    clear : bool
        Transparent instead of the videos' background.
    closeup : bool
        Show only the face.
    outputs : tuple of Path
        Output files, ``.pdf`` or ``.png``.
    """

    folder: StudyFolder
    segment: str
    conditions: tuple[str, ...]
    moments: tuple[Moment, ...]
    inches: float
    clear: bool
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
        The clip.
    seconds : float
        Time from the segment's start.
    size : int
        Pixels of each side.
    clear : bool
        Make the background transparent.
    closeup : bool
        Show only the face.
    output : Path
        A PNG file.
    """
    if output.suffix.lower() != ".png":
        raise InputError("a still is written as PNG", where=output, remedy="End its name with .png")
    material = FigureMaterial.read(folder)
    excerpt = material.segment(segment)
    pose = frame_at(material.clip(excerpt, condition), seconds)
    if closeup:
        material, [[pose]] = material.close_to_faces([[pose]])
    with material.stage(size) as stage:
        picture = panel(stage, pose, material.camera, clear=clear)
    with replacing(output) as draft:
        (picture if clear else picture.convert("RGB")).save(draft, "PNG", optimize=True)


def write_strip(figure: PaperFigure, *, count: int, wave: bool) -> None:
    """Write a strip with a row per condition and a column per moment.

    Parameters
    ----------
    count : int
        Number of loud syllables to show if `figure` has no moments.
    wave : bool
        Draw the waveform of the speech below.
    """
    material = FigureMaterial.read(figure.folder)
    segment = material.segment(figure.segment)
    labels = material.labels(figure.conditions)
    speech = material.speech(segment)
    moments = material.ordered_moments(segment, figure.moments) or loud_moments(speech, count)
    clips = {label: material.clip(segment, name) for name, label in labels.items()}
    rows = [[frame_at(clip, moment.seconds) for moment in moments] for clip in clips.values()]
    material, box, rows = _view(material, figure, rows)
    poses = {
        (label, moment): pose
        for label, row in zip(clips, rows, strict=True)
        for moment, pose in zip(moments, row, strict=True)
    }
    layout = StripLayout(
        inches=figure.inches,
        rows=tuple(clips),
        moments=moments,
        aspect=aspect_of(box),
        wave=wave,
    )
    with material.stage(_drawn_size(layout.panel[0], box)) as stage:
        panels = {
            key: cropped(
                panel(stage, pose, material.camera, clear=figure.clear),
                box,
                layout.panel,
            )
            for key, pose in poses.items()
        }
    draw_strip(layout, panels, speech, clear=figure.clear).save(figure.outputs)


def write_overlay(figure: PaperFigure) -> None:
    """Write a picture of several moments, which make a trail, or of several conditions."""
    material = FigureMaterial.read(figure.folder)
    segment = material.segment(figure.segment)
    labels = material.labels(figure.conditions)
    colours_for(len(labels))
    moments = material.ordered_moments(segment, figure.moments)
    clips = {label: material.clip(segment, name) for name, label in labels.items()}
    poses = [[frame_at(clip, moment.seconds) for moment in moments] for clip in clips.values()]
    material, box, poses = _view(material, figure, poses)
    width = round(figure.inches * DOTS_PER_INCH)
    with material.stage(_drawn_size(width, box)) as stage:
        trails = [
            faded([cut_out(stage, pose, material.camera).crop(box) for pose in row])
            for row in poses
        ]
    size = (width, round(width * aspect_of(box)))
    picture = blended(trails).picture.resize(size, Image.Resampling.LANCZOS)
    caption = " → ".join(moment.label for moment in moments)
    background = material.plan.look.background
    page = draw_overlay(picture, list(clips), caption, clear=figure.clear, background=background)
    page.save(figure.outputs)


def _view(
    material: FigureMaterial, figure: PaperFigure, rows: list[list[MotionClip]]
) -> tuple[FigureMaterial, Box, list[list[MotionClip]]]:
    """Return the material with its camera, the visible part of the picture, and the poses."""
    if figure.closeup:
        material, rows = material.close_to_faces(rows)
        return material, FULL_BOX, rows
    poses = [pose for row in rows for pose in row]
    return material, common_box(material.plan.model, poses, material.camera), rows


def _drawn_size(width: int, box: Box) -> int:
    """Return the size of a whole picture whose part `box` is `width` pixels wide."""
    return math.ceil(width / (box[2] - box[0]))


MAX_WIDTH: Final = 1920
"""Pixels of a video."""


def write_condition_grid(
    folder: StudyFolder,
    *,
    segment: str,
    conditions: Sequence[str],
    closeup: bool,
    output: Path,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Write the video of several conditions side by side.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    segment : str
        Name of the segment.
    conditions : sequence of str
        Each ``name`` or ``name=label``; empty for all but the catch condition.
    closeup : bool
        Show only the faces.
    output : Path
        An MP4 file.
    on_frame : callable
        Called with (finished frames, all frames) after each.
    """
    if output.suffix.lower() != ".mp4":
        raise InputError("a grid is written as MP4", where=output, remedy="End its name with .mp4")
    material = FigureMaterial.read(folder)
    excerpt = material.segment(segment)
    labels = material.labels(conditions)
    fitting_size = MAX_WIDTH // GridLayout(count=len(labels), size=2).columns // 2 * 2
    clips = {label: material.clip(excerpt, name) for name, label in labels.items()}
    if closeup:
        material, faces = material.close_to_faces([[clip] for clip in clips.values()])
        clips = {label: clip for label, [clip] in zip(clips, faces, strict=True)}
    with material.stage(min(material.plan.look.size, fitting_size)) as stage:
        write_grid(
            stage,
            clips,
            material.speech(excerpt, sample_rate=SOUND_RATE),
            text=excerpt.transcript,
            video=output,
            on_frame=on_frame,
        )
