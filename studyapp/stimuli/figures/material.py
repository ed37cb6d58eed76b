"""The material of figures: a study's clips as participants see them, its stage, its speech."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Self

from motion.audio import SPEECH_RATE, Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.segment import Segment
from renderer.clip_video import Stage
from renderer.figures.panels import align_faces, face_camera
from renderer.figures.strip import MAX_MOMENTS, Moment
from renderer.framing import Camera
from renderer.shown_clip import as_shown
from studyapp.stimuli.render_plan import RenderPlan
from studyapp.study.folder import StudyFolder

MAX_PIXELS: Final = 2160


@dataclass(frozen=True)
class FigureMaterial:
    """A study whose motion is complete, ready to be drawn.

    Attributes
    ----------
    plan : RenderPlan
        The study's look and body, the same for all conditions.
    camera : Camera
        The camera for all conditions: the study's own, or one close to the faces.
    """

    plan: RenderPlan
    camera: Camera

    @classmethod
    def read(cls, folder: StudyFolder) -> Self:
        """Read the study in `folder`; its motion must be complete."""
        plan = RenderPlan.of(folder)
        return cls(plan, plan.camera)

    def close_to_faces(
        self, groups: Iterable[Sequence[MotionClip]]
    ) -> tuple[Self, list[list[MotionClip]]]:
        """Return the material with a camera close to the faces, and the clips in front of it."""
        level = align_faces(groups, self.plan.model)
        clips = [clip for group in level for clip in group]
        camera = face_camera(clips, self.plan.model, self.plan.camera)
        return replace(self, camera=camera), level

    def stage(self, size: int) -> Stage:
        """Return the study's stage with `size` × `size` pixels, made even and within limits."""
        even_size = min(max(64, size + size % 2), MAX_PIXELS)
        look = replace(self.plan.look, size=even_size)
        return Stage(self.plan.body, self.camera, look)

    def segment(self, name: str) -> Segment:
        """Return a segment by name."""
        return self.plan.segments[_require_known(name, "segment", list(self.plan.segments))]

    def labels(self, conditions: Sequence[str]) -> dict[str, str]:
        """Return the label of each condition in a figure.

        Parameters
        ----------
        conditions : sequence of str
            Each ``name`` or ``name=label``; empty for all but the catch condition. Without a label,
            a condition has its display name.

        Raises
        ------
        InputError
            If a condition is unknown, or names or labels are not distinct.
        """
        shown, study = self.plan.conditions, self.plan.study
        texts = conditions or [name for name in shown if name != study.catch.condition]
        parts = [text.partition("=") for text in texts]
        names = [_require_known(name, "condition", shown) for name, _, _ in parts]
        labels = [label.strip() or study.display_names[name] for name, _, label in parts]
        for text in (*names, *labels):
            if max(names.count(text), labels.count(text)) > 1:
                raise InputError(
                    f"{text!r} occurs twice in this figure", remedy="Use different labels"
                )
        return dict(zip(names, labels, strict=True))

    def clip(self, segment: Segment, condition: str) -> MotionClip:
        """Return the motion as participants see it."""
        name = _require_known(condition, "condition", self.plan.conditions)
        path = self.plan.folder.clip(name, segment.name)
        plan = self.plan
        rate = plan.look.frame_rate
        clip = read_clip(path)
        return as_shown(clip, plan.model, path, segment.duration, plan.study.freeze, rate)

    def speech(self, segment: Segment, sample_rate: int = SPEECH_RATE) -> Audio:
        """Return the speech of `segment`."""
        path = self.plan.folder.speech / segment.wav
        return read_audio(path, sample_rate=sample_rate).cut(segment.start, segment.end)

    def ordered_moments(self, segment: Segment, moments: Sequence[Moment]) -> tuple[Moment, ...]:
        """Return `moments` in chronological order.

        Raises
        ------
        InputError
            If a moment lies outside the segment, or there are more than `MAX_MOMENTS`.
        """
        if len(moments) > MAX_MOMENTS:
            raise InputError(
                f"{len(moments)} moments are too many", remedy=f"Give 1 to {MAX_MOMENTS}"
            )
        for moment in moments:
            if not 0 <= moment.seconds <= segment.duration:
                raise InputError(
                    f"{moment.seconds:g} s is not within the segment",
                    where=f"segment {segment.name}",
                    remedy=f"Give times from 0 to {segment.duration:.2f} s",
                )
        return tuple(sorted(moments, key=lambda moment: moment.seconds))


def _require_known(name: str, kind: str, known: Sequence[str]) -> str:
    if name not in known:
        raise InputError(f"unknown {kind} {name!r}", remedy=f"Use one of {', '.join(known)}")
    return name
