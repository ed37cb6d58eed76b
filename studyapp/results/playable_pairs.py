"""The pairs of clips that a report plays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from markupsafe import Markup

from analysis.report import wording
from analysis.report.subject import PlayableMotion
from analysis.results.preferred_pairs import PreferredPair, preferred_pairs
from motion.segment import Segment
from renderer.viewer.page import MotionFigures, scripts, style
from studyapp.results.analysed_tasks import AnalysedTask
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def playable_pairs(
    folder: StudyFolder, study: Study, segments: Sequence[Segment], tasks: Sequence[AnalysedTask]
) -> PlayableMotion:
    """Return the most and least preferred pairs of a study, as its report plays them.

    A pair of which a motion cannot be read is left out, with the reason: it may be a video that
    was brought finished, or a file that is gone since.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    study : Study
        Its definition.
    segments : sequence of Segment
        Its speech.
    tasks : sequence of AnalysedTask
        Its answers; the pairs are those of the first task that compares conditions.
    """
    found = (preferred_pairs(task.table, task.left_out.analysed) for task in tasks)
    pairs = next((one for one in found if one), ())
    if not pairs:
        return PlayableMotion(left_out=("Nobody has compared two conditions yet.",))
    by_name = {segment.name: segment for segment in segments}
    figures = MotionFigures(study_look(folder, study))
    playable: list[tuple[PreferredPair, Markup]] = []
    left_out: dict[str, None] = {}
    with wording.labelled(study.display_names):
        for pair in pairs:
            segment = by_name.get(pair.segment)
            if segment is None:
                left_out[f"Segment {pair.segment} is not in the study any more."] = None
                continue
            scene, missing = segment_scene(
                folder, study, segment, (pair.first, pair.second), heard=segment
            )
            for condition, why in missing.items():
                sentence = f"{wording.condition(condition)}, segment {segment.name}: {why}."
                left_out[f"Not playable: {sentence}"] = None
            if not missing:
                labels = {wording.condition(name): clip for name, clip in scene.clips.items()}
                playable.append((pair, figures.figure(replace(scene, clips=labels))))
    return PlayableMotion(
        pairs=tuple(playable),
        sources=figures.sources() if playable else "",
        scripts=scripts() if playable else (),
        style=style() if playable else "",
        left_out=tuple(left_out),
    )
