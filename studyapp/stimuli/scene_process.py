"""The process that packs motion for researchers' pages.

``python -m studyapp.stimuli.scene_process avatar NAME`` writes an avatar's body for ``viewer.js``;
``… scene FOLDER SEGMENT SPEECH LABEL=CONDITION …`` writes a segment's motion. SPEECH is the segment
that is heard, or empty for silence. The output contains labels, but no conditions.
"""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.viewer.packing import packed_avatar
from renderer.viewer.page import data_address, packed_scene, viewed_body
from studyapp.side_process import give_way
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder

PROCESSOR_SECONDS: Final = 60


def scene(root: str, segment: str, speech: str, *labelled: str) -> bytes:
    """Return the motion of a segment as JSON; `InputError` if there is none."""
    folder = StudyFolder(Path(root))
    study = folder.study()
    segments = {item.name: item for item in folder.segments_of(study)}
    if segment not in segments:
        raise InputError(f"segment {segment!r} is no longer in the study")
    conditions = {label: name for label, _, name in (text.rpartition("=") for text in labelled)}
    shown, missing = segment_scene(
        folder, study, segments[segment], conditions.values(), speech=segments.get(speech)
    )
    clips = {label: shown.clips[c] for label, c in conditions.items() if c in shown.clips}
    notes = [f"{label}: {missing[c]}." for label, c in conditions.items() if c in missing]
    if not clips:
        raise InputError(" ".join(notes).removesuffix("."))
    look = study_look(folder, study)
    packed = packed_scene(replace(shown, clips=clips), viewed_body(look), look, data_address)
    return json.dumps(packed | {"notes": notes}).encode()


COMMANDS: Final[dict[str, Callable[..., bytes]]] = {"avatar": packed_avatar, "scene": scene}


def main(arguments: Sequence[str]) -> int:
    """Write the output of a command; return the exit status."""
    command, *options = arguments
    try:
        sys.stdout.buffer.write(COMMANDS[command](*options))
    except InputError as error:
        print(" ".join(error.what.split()), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    give_way(PROCESSOR_SECONDS)
    sys.exit(main(sys.argv[1:]))
