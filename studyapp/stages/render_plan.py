"""What a study needs rendered, and what each file depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from motion.body import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.freeze import freeze
from motion.ground import stand_on_ground
from motion.segment import Segment
from renderer.framing import Camera, frame_clips
from renderer.job import ClipJob, PairJob
from renderer.look import Look
from renderer.version import RENDERER_VERSION
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import ClipVideo, PairVideo
from studyapp.definition.study import Study
from studyapp.stages.digest import digest
from studyapp.stages.recordings import check_same_length
from studyapp.stages.shown_body import body_file, expression_matrix_file, left_out, shown_body


def read_motion_shown(
    folder: StudyFolder, study: Study, segments: Sequence[Segment]
) -> dict[tuple[str, str], MotionClip]:
    """Return each (condition, segment)'s clip as it is shown, frozen channels still.

    A clip that cannot be read, or does not fit its speech, is left out: making its video fails,
    which is reported, and the rest goes on.

    Raises
    ------
    InputError
        If clips are missing, or none can be used.
    """
    wanted = [(c, s) for c in study.shown_conditions for s in segments]
    missing = [(c, s) for c, s in wanted if not folder.clip(c, s.name).exists()]
    if missing:
        condition, segment = missing[0]
        imported = condition in study.conditions and study.conditions[condition].generator is None
        remedy = "Bring it in with 'motionjury import'" if imported else "Run 'motionjury generate'"
        raise InputError(
            f"{len(missing)} of {len(wanted)} motion clips are missing, the first is condition "
            f"{condition!r} for segment {segment.name}",
            where=folder.clip(condition, segment.name),
            remedy=remedy,
        )
    shown = {}
    broken: list[InputError] = []
    for condition, segment in wanted:
        path = folder.clip(condition, segment.name)
        try:
            clip = read_clip(path)
            check_same_length(clip, segment, path)
        except InputError as error:
            broken.append(error)
        else:
            shown[condition, segment.name] = freeze(clip, study.freeze)
    if broken and not any(name != study.catch.condition for name, _ in shown):
        raise broken[0]
    return shown


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
        segments = {segment.name: segment for segment in folder.segments()}
        shown = read_motion_shown(folder, study, tuple(segments.values()))
        body, model = body_file(folder, study), shown_body(folder, study)
        matrix = expression_matrix_file(folder, study)
        look = _look(study)
        camera = _camera(shown, study, model, look)
        shared = (RENDERER_VERSION, body.name, body.stat().st_size, camera, look, study.freeze)
        clips = tuple(
            ClipVideo(
                segment=segment.name,
                condition=condition,
                file=f"videos/clips/{condition}/{segment.name}.mp4",
                duration=segment.duration,
                key=digest(
                    shared,
                    segment,
                    folder.speech / segment.wav,
                    folder.clip(condition, segment.name),
                    *([matrix] if matrix else []),
                ),
            )
            for condition in study.shown_conditions
            for segment in segments.values()
        )
        keys = {(clip.segment, clip.condition): clip.key for clip in clips}
        pairs = tuple(
            PairVideo(
                segment=segment.name,
                left=left,
                right=right,
                file=f"videos/pairs/{digest(segment.name, left, right)}.mp4",
                duration=segment.duration,
                key=digest(keys[segment.name, left], keys[segment.name, right]),
            )
            for left, right in study.pairs
            for segment in segments.values()
        )
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
    def frames_folder(self) -> Path:
        """Where the lossless frames are kept."""
        return self.folder.videos / ".frames"

    def frames(self, segment: str, condition: str) -> Path:
        """Return the lossless frames from which the pairs of a clip are composed."""
        return self.frames_folder / f"{self.keys[segment, condition]}.mkv"

    def clip_job(self, clip: ClipVideo) -> ClipJob:
        """Return the work that makes `clip`."""
        segment = self.segments[clip.segment]
        return ClipJob(
            name=clip.file,
            motion=self.folder.clip(clip.condition, clip.segment),
            speech=self.folder.speech / segment.wav,
            start=segment.start,
            end=segment.end,
            freeze=self.study.freeze,
            body=self.body,
            camera=self.camera,
            look=self.look,
            frames=self.frames(clip.segment, clip.condition),
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


def _look(study: Study) -> Look:
    video = study.video
    return Look(
        size=video.size,
        frame_rate=video.frame_rate,
        framing=video.framing,
        avatar=video.avatar,
    )


def _camera(
    shown: Mapping[tuple[str, str], MotionClip], study: Study, body: BodyModel, look: Look
) -> Camera:
    """Frame all conditions alike, the catch motion left aside."""
    clips = [
        stand_on_ground(clip, body.joints(clip.betas))
        for (name, _), clip in shown.items()
        if name != study.catch.condition
    ]
    return frame_clips(clips, body, look)
