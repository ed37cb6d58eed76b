"""The process that packs motion for researchers' pages.

``python -m studyapp.stimuli.scene_process avatar NAME`` writes the body of an avatar, and ``… scene
FOLDER SEGMENT SPEECH LABEL=CONDITION …`` a segment's motion, as ``viewer.js`` reads them. SPEECH is
the segment that is heard, and empty for silence. Motion is called by its label alone.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.viewer.avatar import packed_avatar
from renderer.viewer.page import data_address, packed_scene, viewed_body
from studyapp.side_process import give_way
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder

PROCESSOR_SECONDS: Final = 60


def scene(root: str, segment: str, speech: str, *labelled: str) -> bytes:
    """Return the motion of a segment in JSON.

    Raises
    ------
    InputError
        If there is nothing to play.
    """
    folder = StudyFolder(Path(root))
    study = folder.study()
    segments = {each.name: each for each in folder.segments_of(study)}
    if segment not in segments:
        raise InputError(f"segment {segment!r} is not in the study any more")
    conditions = {label: name for label, _, name in (each.rpartition("=") for each in labelled)}
    found, missing = segment_scene(
        folder, study, segments[segment], conditions.values(), heard=segments.get(speech)
    )
    clips = {label: found.clips[c] for label, c in conditions.items() if c in found.clips}
    notes = [f"{label}: {missing[c]}." for label, c in conditions.items() if c in missing]
    if not clips:
        raise InputError(" ".join(notes).removesuffix("."))
    look = study_look(folder, study)
    packed = packed_scene(replace(found, clips=clips), viewed_body(look), look, data_address)
    return json.dumps(packed | {"notes": notes}).encode()


MADE: Final[dict[str, Callable[..., bytes]]] = {"avatar": packed_avatar, "scene": scene}


def main(arguments: Sequence[str]) -> int:
    """Write what is asked for; return the exit status."""
    what, *which = arguments
    try:
        sys.stdout.buffer.write(MADE[what](*which))
    except InputError as error:
        print(" ".join(error.what.split()), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    give_way(PROCESSOR_SECONDS)
    sys.exit(main(sys.argv[1:]))
