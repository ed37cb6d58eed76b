"""What BEAT's names tell."""

from __future__ import annotations

from collections import Counter

import pytest

from training.data.beat import BeatName


def named(name: str) -> BeatName:
    found = BeatName.parse(name)
    assert found is not None
    return found


def test_a_name_tells_speaker_type_and_texts() -> None:
    name = named("12_zhao_2_1_8")
    assert (name.number, name.speaker, name.recording_type) == (12, "zhao", 2)
    assert (name.start, name.end) == (1, 8)


@pytest.mark.parametrize(
    "name", ["scott", "2_scott_0_1", "2_scott_0_1_1_mirrored", "scott_2_0_1_1", "2_scott_0_1_b"]
)
def test_other_names_tell_nothing(name: str) -> None:
    assert BeatName.parse(name) is None


@pytest.mark.parametrize(
    ("texts", "emotion"),
    [
        *(("0_1_1", "neutral"), ("0_64_64", "neutral"), ("0_65_65", "happiness")),
        *(("0_73_73", "anger"), ("0_86_86", "sadness"), ("0_87_94", "contempt")),
        *(("2_102_102", "surprise"), ("0_103_103", "fear"), ("0_118_118", "disgust")),
        *(("0_119_119", ""), ("0_57_72", ""), ("1_3_3", "")),
    ],
)
def test_texts_tell_the_emotion_of_whoever_speaks_alone(texts: str, emotion: str) -> None:
    assert named(f"2_scott_{texts}").emotion == emotion


def test_splits_of_four_hours_are_as_many_minutes_as_published() -> None:
    speeches = Counter(named(f"2_scott_0_{text}_{text}").published_split for text in range(1, 119))
    assert speeches == {"train": 88, "validation": 15, "test": 15}
    talks = [named(f"2_scott_1_{text}_{text}").published_split for text in range(1, 13)]
    assert talks == ["test", *["train"] * 10, "validation"]


def test_splits_of_one_hour_keep_recordings_whole() -> None:
    there = [*range(1, 17), 65, 66, 73, 74, 81, 82, 87, 88, 95, 96, 103, 104, 111, 112, 118]
    splits = {text: named(f"5_stewart_0_{text}_{text}").published_split for text in there}
    assert [text for text in there if splits[text] == "validation"] == [5, 6, 7, 8]
    tested = [1, 2, 3, 4, 65, 73, 81, 87, 95, 103, 111]
    assert [text for text in there if splits[text] == "test"] == tested


@pytest.mark.parametrize(
    "name", ["12_zhao_2_1_1", "2_scott_0_1_8", "31_eve_0_1_1", "2_a_0_119_119"]
)
def test_the_published_rule_says_nothing_of_other_recordings(name: str) -> None:
    assert named(name).published_split is None
