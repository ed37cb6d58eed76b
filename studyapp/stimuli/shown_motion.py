"""The motion that a study shows, as it is shown."""

from __future__ import annotations

from collections.abc import Sequence

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.freeze import freeze
from motion.segment import Segment
from studyapp.stimuli.recordings import check_same_length
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def moved_clips(study: Study, segments: Sequence[Segment]) -> list[tuple[str, Segment]]:
    """Return every (condition, segment) whose motion is shown, condition after condition."""
    moved = {
        (stimulus.condition, stimulus.segment): stimulus.condition
        for content in study.contents(segments)
        for stimulus in content
        if not study.is_finished(stimulus.condition)
    }
    order = dict.fromkeys(moved.values())
    return [(c, s) for c in order for s in segments if (c, s.name) in moved]


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
    wanted = moved_clips(study, segments)
    if not wanted:
        raise InputError(
            "all videos of this study were brought finished, and there is no motion to draw",
            where=folder.definition,
            remedy="Take a study whose conditions have motion",
        )
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
