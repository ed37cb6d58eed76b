"""Selection of a corpus' takes for the study, the strips of frames and the feature networks."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from PIL import Image

from motion.audio import read_audio
from motion.files import replacing
from motion.segment import EMOTIONS
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import GROUND_TRUTH
from training.data.take import Take as RecordedTake

_WIDE: Final = 840
_COLOURS: Final = 128


def shown_segment(study: StudyFolder) -> str:
    """Return the shortest segment of the study."""
    return min(study.segments(), key=lambda one: (one.duration, one.name)).name


def write_picture(strip: Path, to: Path) -> None:
    """Write a strip with fewer pixels and colours, so that the repository stays small."""
    with Image.open(strip) as picture:
        high = round(picture.height * _WIDE / picture.width)
        small = picture.convert("RGB").resize((_WIDE, high), Image.Resampling.LANCZOS)
    with replacing(to) as draft:
        small.quantize(_COLOURS, dither=Image.Dither.NONE).save(draft, "png", optimize=True)


def shown_takes(takes: Sequence[RecordedTake], each: int) -> list[RecordedTake]:
    """Return the shortest test takes of each emotion, by speakers of the training takes."""
    known = {take.speaker for take in takes if take.split == "train"}
    test = [take for take in takes if take.split == "test" and take.speaker in known]
    seconds = {take.name: read_audio(take.speech, sample_rate=None).duration for take in test}
    test.sort(key=lambda take: (seconds[take.name], take.name))
    return [
        take
        for emotion in EMOTIONS
        for take in [take for take in test if take.emotion == emotion][:each]
    ]


def learned_takes(takes: Sequence[RecordedTake], each: int) -> list[RecordedTake]:
    """Return `each` training takes of each emotion for feature networks, of all speakers."""
    chosen = []
    for emotion in EMOTIONS:
        own = [take for take in takes if take.split == "train" and take.emotion == emotion]
        count = min(each, len(own))
        chosen += [own[number * len(own) // count] for number in range(count)]
    return chosen


def bring(folder: StudyFolder, takes: Iterable[RecordedTake]) -> None:
    """Import whole takes as ground truth; existing ones stay."""
    there = folder.speech / "segments.csv"
    known = {segment.name for segment in folder.segments()} if there.exists() else set()
    for take in takes:
        if take.name in known:
            continue
        recorded = Take(
            motion=take.motion,
            speech=take.speech,
            frame_rate=None,
            segment_seconds=None,
            condition=GROUND_TRUTH,
            speaker=take.speaker,
            emotion=take.emotion,
        )
        import_take(folder, recorded)
