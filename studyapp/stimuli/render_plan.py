"""The videos of a study, and what each file depends on."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

from motion.body.model import BodyModel
from motion.files import digest
from motion.placement import stand_on_ground
from motion.segment import Segment
from renderer.framing import Camera, frame_clips
from renderer.look import BACKGROUND, RENDERER_VERSION, Look
from renderer.video_jobs import ClipJob, DubJob, PairJob
from studyapp.stimuli.shown_motion import (
    body_file,
    left_out,
    read_motion_shown,
    shown_body,
    shown_clips,
    study_look,
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
    keys : mapping of (segment, condition) to str
        Digests of everything that clips depend on.
    clips, pairs : tuple
        The records in `stimuli.json` once the videos exist.
    model : BodyModel
        The body in the file `body`.
    notes : tuple of str
        Motion that the body cannot show.
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
        look = study_look(folder, study)
        matrix = look.expression_matrix
        framed = [clip for (name, _), clip in shown.items() if name != study.catch.condition]
        standing = [stand_on_ground(clip, model.joints(clip.betas)) for clip in framed]
        camera = frame_clips(standing, model, look)
        chosen = () if look.background == BACKGROUND else (look.background,)
        size = body.stat().st_size
        general = replace(look, expression_matrix=None)  # the file counts, not its path
        shared = (RENDERER_VERSION, body.name, size, camera, general, study.freeze, *chosen)
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
            for condition, segment in shown_clips(study, tuple(segments.values()))
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
            look=look,
            keys=keys,
            clips=clips,
            pairs=pairs,
            notes=left_out(((name, clip) for (name, _), clip in shown.items()), model),
        )

    @property
    def conditions(self) -> tuple[str, ...]:
        """All conditions with motion that are shown."""
        return tuple(dict.fromkeys(clip.condition for clip in self.clips))

    @cached_property
    def sides(self) -> frozenset[tuple[str, str]]:
        """All (segment, condition) that pairs are composed of."""
        return sides_of(self.pairs)

    @property
    def frames_folder(self) -> Path:
        """The cache of lossless frames."""
        return self.folder.videos / ".frames"

    def frames(self, segment: str, condition: str) -> Path:
        """Return the file of a clip's lossless frames, of which its pairs are composed."""
        return self.frames_folder / f"{self.keys[segment, condition]}.mkv"

    def needed_frames(self, clip: ClipVideo) -> Path | None:
        """Return the file of lossless frames that pairs need of `clip`; None if none does."""
        side = (clip.segment, clip.condition)
        return self.frames(*side) if clip.speech is None and side in self.sides else None

    def clip_job(self, clip: ClipVideo) -> ClipJob | DubJob:
        """Return the job of `clip`; with other speech, it reuses the picture of the clip."""
        if clip.speech is not None:
            return self._dub_job(clip, self.segments[clip.speech])
        speech = self.segments[clip.segment]
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
            frames=self.needed_frames(clip),
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
        """Return the job that composes `pair` of its two clips."""
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
    """Return all (segment, condition) that `pairs` are composed of."""
    return frozenset((pair.segment, side) for pair in pairs for side in (pair.left, pair.right))


def _mismatched(
    folder: StudyFolder,
    study: Study,
    segments: Mapping[str, Segment],
    contents: Sequence[Content],
    keys: Mapping[tuple[str, str], str],
) -> tuple[ClipVideo, ...]:
    """Return the clips with speech of another segment."""
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
