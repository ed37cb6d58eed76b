"""AMUSE's motion when it is given another emotion (EmoEdit of Table 1, Fig. A.12)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators.evaluator import Evaluator, load_evaluator
from analysis.metrics.emotion_accuracy import emotion_confusion
from analysis.metrics.kinematics import WRISTS, joint_motion, select
from analysis.metrics.scores import EmotionConfusion
from benchmarks.learned_motion.compared_study import segment_of
from benchmarks.learned_motion.following import (
    Followed,
    MeanFollowed,
    Speech,
    follow,
    mean_followed,
)
from benchmarks.learned_motion.networks import Network
from benchmarks.learned_motion.recordings import FRAME_RATE
from generators.amuse.generate import Amuse
from generators.interface import SpeechSegment
from generators.learned_settings import AmuseSettings
from motion.audio import read_audio
from motion.clip import MotionClip
from motion.segment import EMOTIONS
from training.corpus.truth import mean_speed
from training.data.take import Take


@dataclass(frozen=True, kw_only=True)
class Edited:
    """Effects of an edit of the emotion.

    Attributes
    ----------
    confusion : EmotionConfusion
        A row for each emotion given, a column for each emotion recognised.
    speaker_before, speaker_after : float
        Share of clips attributed to their own speaker, unedited and edited.
    speed : float
        Correlation of the wrists' speed before and after the edit, from the same noise.
    strokes_before, strokes_after : MeanFollowed
        Stroke alignment with their own speech, above chance.
    """

    confusion: EmotionConfusion
    speaker_before: float
    speaker_after: float
    speed: float
    strokes_before: MeanFollowed
    strokes_after: MeanFollowed

    @property
    def accuracy(self) -> float:
        """Share of edited clips whose emotion is recognised as the one given."""
        counts = np.array(self.confusion.counts)
        return float(np.trace(counts) / counts.sum())


BY_NAME: Final = "by name"
BY_RECORDING: Final = "by another recording"

Told = Callable[[Take, str], str | Path]
"""Returns the replacement for the emotion of a take's speech: its name, or a recording."""


def by_name(_: Take, emotion: str) -> str:
    """Give an emotion by its name: the mean latent that the speech model learned for it."""
    return emotion


def by_recording(takes: Sequence[Take], spoken: Mapping[str, str]) -> Told:
    """Give an emotion by another of `takes`, in which the same speaker says something else."""

    def recording(take: Take, emotion: str) -> Path:
        return next(
            other.speech
            for other in takes
            if (other.speaker, other.emotion) == (take.speaker, emotion)
            and spoken[other.name] != spoken[take.name]
        )

    return recording


def edit(
    network: Network,
    root: Path,
    takes: Sequence[Take],
    speech: Mapping[str, Speech],
    spoken: Mapping[str, str],
    judges: Mapping[str, Path],
    told: Told,
) -> Edited:
    """Give a network each of the other emotions for every take, and classify its motion.

    Parameters
    ----------
    network : Network
        A network of AMUSE.
    root : Path
        Folder of the networks' files.
    takes : sequence of Take
        Takes whose speech is used.
    speech, spoken : mapping of take
        The truth about them, see `benchmarks.learned_motion.truth`.
    judges : mapping of str to Path
        Networks that classify motion by ``emotion`` and ``speaker``.
    told : Told
        Replaces the emotion of the speech.
    """
    emotion, speaker = (load_evaluator(judges[name]) for name in ("emotion", "speaker"))

    @cache
    def amuse(stands_in: str | Path | None) -> Amuse:
        settings = {**network.files(root), "emotion": stands_in}
        return Amuse(AmuseSettings.model_validate(settings), "cpu")

    given, taken_for, speeds = [], [], []
    kept: dict[str, list[bool]] = {"before": [], "after": []}
    strokes: dict[str, dict[str, Followed]] = {"before": {}, "after": {}}
    groups = {}
    for number, take in enumerate(takes):
        audio = read_audio(take.speech)
        heard = SpeechSegment(segment=segment_of(take, audio), audio=audio)
        before = amuse(None).generate(heard, seed=number, frame_rate=FRAME_RATE)
        kept["before"].append(_named(speaker, before) == take.speaker)
        strokes["before"][take.name] = follow(before, speech[take.name])
        groups[take.name] = spoken[take.name]
        for other in EMOTIONS:
            if other == take.emotion:
                continue
            after = amuse(told(take, other)).generate(heard, seed=number, frame_rate=FRAME_RATE)
            given.append(other)
            taken_for.append(_named(emotion, after))
            kept["after"].append(_named(speaker, after) == take.speaker)
            speeds.append(float(np.corrcoef(_speed(before), _speed(after))[0, 1]))
            edited = f"{take.name} {other}"
            strokes["after"][edited] = follow(after, speech[take.name])
            groups[edited] = spoken[take.name]
    return Edited(
        confusion=emotion_confusion(
            given, taken_for, emotion.labels, condition="edited", network=emotion.sha256
        ),
        speaker_before=float(np.mean(kept["before"])),
        speaker_after=float(np.mean(kept["after"])),
        speed=float(np.mean(speeds)),
        strokes_before=mean_followed(strokes["before"], groups, "strokes"),
        strokes_after=mean_followed(strokes["after"], groups, "strokes"),
    )


def _named(judge: Evaluator, clip: MotionClip) -> str:
    """Return a network's classification of a clip, as the mean over its windows."""
    return judge.labels[int(judge.classify(clip).mean(axis=0).argmax())]


def _speed(clip: MotionClip) -> NDArray[np.float64]:
    positions = joint_motion(clip, clip.frame_rate).relative
    return mean_speed(select(positions, WRISTS), clip.frame_rate)
