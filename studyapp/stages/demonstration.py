"""A whole study on synthetic speech, so that anyone can see the line run without data."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from motion.audio import read_audio
from motion.segment import Segment
from motion.segments_table import write_segments
from motion.synthetic_speech import speak
from studyapp.definition.conditions import Condition
from studyapp.definition.creation import new_study
from studyapp.definition.folder import StudyFolder

SENTENCES: Final = MappingProxyType(
    {
        "neutral": "The number nine tram leaves from the station square every twelve minutes, "
        "and it stops at the museum on its way to the harbour.",
        "happiness": "We got the house! They called this morning, and next summer we will all "
        "be having breakfast under that enormous cherry tree.",
        "anger": "I have told them three times already. Three times! And still nobody has "
        "bothered to fix that lock or even to call me back.",
        "sadness": "Her chair is still by the window. I keep setting the table for two, "
        "and then I remember that there is nobody coming home.",
        "contempt": "Oh, of course he knows better. He read half an article once, and now he is "
        "explaining medicine to a room full of doctors.",
        "surprise": "Wait, you walked all the way here? In this weather? I opened the door "
        "and I honestly could not believe my own eyes.",
        "fear": "Did you hear that? There is someone on the stairs again. Please stay here "
        "with me, and do not turn on the light.",
        "disgust": "The milk had gone green, there was hair in the sink, and something under "
        "the counter was moving. I could not stay in that kitchen.",
    }
)
"""One sentence per emotion, each four seconds or longer when spoken."""

CONDITIONS: Final = MappingProxyType(
    {
        "rule_based": Condition(generator="rule_based"),
        "mismatched": Condition(generator="mismatched", source="rule_based"),
        "static": Condition(generator="static"),
    }
)

_SPEAKER: Final = "espeak-ng"


def prepare_demo(folder: StudyFolder) -> bool:
    """Make the demonstration study and speak its sentences; what is there already is kept.

    Returns
    -------
    bool
        Whether anything had to be made.
    """
    if not folder.definition.exists():
        new_study(
            folder.definition,
            name="demo-study",
            title="Which speaker do you prefer?",
            reference="rule_based",
            conditions=CONDITIONS,
        )
    if (folder.speech / "segments.csv").exists():
        return False
    segments = []
    for emotion, sentence in SENTENCES.items():
        path = folder.speech / f"{emotion}.wav"
        speak(sentence, emotion, path)
        segments.append(
            Segment(
                name=emotion,
                wav=path.name,
                start=0.0,
                end=round(read_audio(path, sample_rate=None).duration, 6),
                speaker=_SPEAKER,
                emotion=emotion,
                transcript=sentence,
            )
        )
    write_segments(folder.speech, segments)
    return True
