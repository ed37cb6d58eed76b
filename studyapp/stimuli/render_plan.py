"""What a study needs rendered, and what each file depends on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.files import digest
from motion.placement import stand_on_ground
from motion.segment import Segment
from renderer.framing import Camera, frame_clips
from renderer.jobs.job import ClipJob, DubJob, PairJob
from renderer.look import BACKGROUND, RENDERER_VERSION, Look
from studyapp.stimuli.shown_motion import (
    background_of,
    body_file,
    expression_matrix_file,
    left_out,
    moved_clips,
    read_motion_shown,
    shown_body,
)
from studyapp.study.design.trial import Content
from studyapp.study.folder import StudyFolder
from studyapp.study.media import ClipVideo, PairVideo
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class RenderPlan:
    """Every video of a study, with one camera and one look for all.

    Attributes
    ----------
    keys : mapping
        What each (segment, condition)'s clip depends on.
    clips, pairs : tuple
        The records that `stimuli.json` holds once the videos are there.
    model : BodyModel
        The body in the file `body`.
    notes : tuple of str
        What of the conditions' motion the body cannot show.
    """

    folder: StudyFolder
    study: Study
    segments: Mapping[str, Segment]
    body: Path
    model: BodyModel
    camera: Camera
    look: Look
    keys: Mapping[tuple[str, str], str]
    clips: tuple[ClipVideo, ...]
    pairs: tuple[PairVideo, ...]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, folder: StudyFolder) -> Self:
        """Plan the videos of `folder`; its motion must be complete."""
        study = folder.study()
        segments = {segment.name: segment for segment in folder.segments_of(study)}
        shown = read_motion_shown(folder, study, tuple(segments.values()))
        body, model = body_file(folder, study), shown_body(folder, study)
        matrix = expression_matrix_file(folder, study)
        look = video_look(study)
        framed = [clip for (name, _), clip in shown.items() if name != study.catch.condition]
        camera = study_camera(framed, study, model)
        chosen = () if look.background == BACKGROUND else (look.background,)
        size = body.stat().st_size
        shared = (RENDERER_VERSION, body.name, size, camera, look, study.freeze, *chosen)
        contents = list(study.contents(tuple(segments.values())))
        own = tuple(
            ClipVideo(
                segment=segment.name,
                condition=condition,
                file=_clip_file(condition, segment.name),
                duration=segment.duration,
                key=digest(
                    shared,
                    segment,
                    folder.speech / segment.wav,
                    folder.clip(condition, segment.name),
                    *([matrix] if matrix else []),
                ),
            )
            for condition, segment in moved_clips(study, tuple(segments.values()))
        )
        keys = {(clip.segment, clip.condition): clip.key for clip in own}
        pairs = tuple(
            PairVideo(
                segment=left.segment,
                left=left.condition,
                right=right.condition,
                file=f"videos/pairs/{digest(left.segment, left.condition, right.condition)}.mp4",
                duration=segments[left.segment].duration,
                key=digest(
                    keys[left.segment, left.condition], keys[right.segment, right.condition]
                ),
            )
            for left, right in (content for content in contents if len(content) > 1)
        )
        clips = (*own, *_mismatched(folder, study, segments, contents, keys))
        return cls(
            folder=folder,
            study=study,
            segments=segments,
            body=body.absolute(),
            model=model,
            camera=camera,
            look=replace(look, expression_matrix=matrix),
            keys=keys,
            clips=clips,
            pairs=pairs,
            notes=left_out(((name, clip) for (name, _), clip in shown.items()), model.abilities),
        )

    @property
    def conditions(self) -> tuple[str, ...]:
        """Every condition that has motion and is shown."""
        return tuple(dict.fromkeys(clip.condition for clip in self.clips))

    @cached_property
    def sides(self) -> frozenset[tuple[str, str]]:
        """Each (segment, condition) that pairs are composed from."""
        return sides_of(self.pairs)

    @property
    def frames_folder(self) -> Path:
        """Where the lossless frames are kept."""
        return self.folder.videos / ".frames"

    def frames(self, segment: str, condition: str) -> Path:
        """Return the lossless frames from which the pairs of a clip are composed."""
        return self.frames_folder / f"{self.keys[segment, condition]}.mkv"

    def clip_job(self, clip: ClipVideo) -> ClipJob | DubJob:
        """Return the work that makes `clip`; with another speech, it has its own one's picture."""
        if clip.speech is not None:
            return self._dub_job(clip, self.segments[clip.speech])
        speech = self.segments[clip.segment]
        shown = (clip.segment, clip.condition)
        return ClipJob(
            name=clip.file,
            motion=self.folder.clip(clip.condition, clip.segment),
            speech=self.folder.speech / speech.wav,
            start=speech.start,
            end=speech.end,
            freeze=self.study.freeze,
            body=self.body,
            camera=self.camera,
            look=self.look,
            frames=self.frames(*shown) if shown in self.sides else None,
            video=self.folder.root / clip.file,
        )

    def _dub_job(self, clip: ClipVideo, speech: Segment) -> DubJob:
        return DubJob(
            name=clip.file,
            picture=self.folder.root / _clip_file(clip.condition, clip.segment),
            speech=self.folder.speech / speech.wav,
            start=speech.start,
            end=min(speech.end, speech.start + clip.duration),
            seconds=clip.duration,
            video=self.folder.root / clip.file,
        )

    def pair_job(self, pair: PairVideo) -> PairJob:
        """Return the work that composes `pair` from its two clips."""
        segment = self.segments[pair.segment]
        return PairJob(
            name=pair.file,
            left=self.frames(pair.segment, pair.left),
            right=self.frames(pair.segment, pair.right),
            speech=self.folder.speech / segment.wav,
            start=segment.start,
            end=segment.end,
            video=self.folder.root / pair.file,
            look=self.look,
        )


def sides_of(pairs: Iterable[PairVideo]) -> frozenset[tuple[str, str]]:
    """Return each (segment, condition) that `pairs` are composed from."""
    return frozenset((pair.segment, side) for pair in pairs for side in (pair.left, pair.right))


def _mismatched(
    folder: StudyFolder,
    study: Study,
    segments: Mapping[str, Segment],
    contents: Sequence[Content],
    keys: Mapping[tuple[str, str], str],
) -> tuple[ClipVideo, ...]:
    """Return the clips that are heard with another speech than their own."""
    return tuple(
        ClipVideo(
            segment=shown.segment,
            condition=shown.condition,
            speech=shown.speech,
            file=_clip_file(shown.condition, f"{shown.segment}@{shown.speech}"),
            duration=segments[shown.segment].duration,
            key=digest(
                keys[shown.segment, shown.condition],
                segments[shown.speech],
                folder.speech / segments[shown.speech].wav,
            ),
        )
        for (shown, *others) in contents
        if not others
        and not study.is_finished(shown.condition)
        and shown.speech not in (None, shown.segment)
    )


def _clip_file(condition: str, name: str) -> str:
    return f"videos/clips/{condition}/{name}.mp4"


def video_look(study: Study) -> Look:
    """Return how the study's videos look."""
    video = study.video
    return Look(
        size=video.size,
        frame_rate=video.frame_rate,
        framing=video.framing,
        view=video.view,
        background=background_of(study),
        avatar=video.avatar,
    )


def study_camera(clips: Iterable[MotionClip], study: Study, body: BodyModel) -> Camera:
    """Return the camera of a study's `clips`, frozen channels still; leave the catch motion out."""
    standing = [stand_on_ground(clip, body.joints(clip.betas)) for clip in clips]
    return frame_clips(standing, body, video_look(study))
