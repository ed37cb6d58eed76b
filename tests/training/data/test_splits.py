"""Splits of takes, and held-out recordings."""

from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from tests.training.data.recordings import beat_take
from training.data.beat import BeatName
from training.data.folders import read_takes
from training.data.splitting import held_out_recordings, read_split_list, split_by_hash
from training.data.take import Split, TakeFolder

NAMES = ("2_scott_0_9_9", "2_scott_0_10_10", "2_scott_0_11_11")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in NAMES:
        beat_take(tmp_path, name)
    return tmp_path


def splits_of(takes: TakeFolder) -> dict[str, str]:
    return {take.name: take.split for take in takes.takes}


WANTED = dict(zip(NAMES, ("train", "validation", "test"), strict=True))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "name,split\n{0},train\n{1},validation\n{2},test\n"),
        ("a.csv", "id,type\r\n{0},train\r\n{1},val\r\n{2},test\r\n"),
        ("a.csv", "\ufeffspeaker,name,Split\ns,{0}.bvh,Training\ns,{1}.wav,dev\ns,{2},TEST\n\n"),
        ("a.json", '{{"train": ["{0}"], "val": ["{1}"], "test": ["{2}.npz"]}}'),
    ],
)
def test_lists_are_read_in_the_forms_people_write(folder: Path, name: str, text: str) -> None:
    path = folder / "lists" / name
    path.parent.mkdir()
    path.write_bytes(text.format(*NAMES).encode())
    assert splits_of(read_takes(folder, split_list=path)) == WANTED


def test_missing_and_unlisted_clips_are_reported(folder: Path) -> None:
    (folder / "splits.csv").write_text(
        f"name,split\n{NAMES[0]},train\n{NAMES[1]},additional\n2_scott_0_12_12,test\n"
    )
    result = read_takes(folder)
    assert splits_of(result) == {NAMES[0]: "train"}
    assert result.notes == (
        "splits by splits.csv: 1 train, 0 validation and 0 test",
        f"2 takes ({NAMES[1]}, {NAMES[2]}) left out, to which the list gives no split",
        "1 name (2_scott_0_12_12) of the list not found",
    )


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "name,split\na,train\na.wav,test\n", r"a\.csv: 'a' is in two splits"),
        ("a.csv", "name,split\na,additional\na,test\n", "'a' is in two splits"),
        ("a.csv", "first,second,third\n1,2,3\n", "it has the columns first, second, third"),
        ("a.csv", "", "cannot be read"),
        ("a.json", '["a"]', "cannot be read .*validation error"),
        ("a.json", "{", "cannot be read"),
    ],
)
def test_unusable_lists_are_refused_with_the_reason(
    tmp_path: Path, name: str, text: str, message: str
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        read_split_list(tmp_path / name)


def test_missing_lists_and_lists_of_other_takes_are_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_takes(folder, split_list=folder / "gone.csv")
    (folder / "splits.csv").write_text("name,split\nother,train\n")
    with pytest.raises(InputError, match="names none of the 3 takes"):
        read_takes(folder)


def test_without_a_list_the_published_rule_applies_and_is_named(folder: Path) -> None:
    beat_take(folder, "2_scott_0_1_1")
    result = read_takes(folder)
    assert splits_of(result) == {**dict.fromkeys(NAMES, "train"), "2_scott_0_1_1": "test"}
    assert result.notes == (
        "splits by the rule published with BEAT: 3 train, 0 validation and 1 test",
    )


@given(st.sets(st.text(min_size=1, max_size=5), max_size=60))
def test_hashes_split_as_documented_in_any_order(names: set[str]) -> None:
    splits = split_by_hash(sorted(names))
    assert splits == split_by_hash(sorted(names, reverse=True))
    number = Counter(splits.values())
    kept = max(round(len(names) / 10), 1 if len(names) > 2 else 0)
    assert number["test"] == number["validation"] == kept
    assert number["train"] == len(names) - 2 * kept


def test_each_label_holds_out_its_share_of_whole_recordings_in_any_order() -> None:
    recordings = [f"r{number // 2}" for number in range(24)]
    labels = ["calm"] * 20 + ["rare"] * 4
    drawn = held_out_recordings(recordings, labels, share=0.2, seed=0)
    assert (len(drawn & set(recordings[:20])), len(drawn & set(recordings[20:]))) == (2, 1)
    assert drawn == held_out_recordings(recordings[::-1], labels[::-1], share=0.2, seed=0)
    assert drawn != held_out_recordings(recordings, labels, share=0.2, seed=1)
    # A label of one recording stays to be learned from.
    assert held_out_recordings(["a", "a", "b"], ["x", "x", "y"], share=0.2, seed=0) == frozenset()


def published(name: str) -> Split | None:
    parsed = BeatName.parse(name)
    assert parsed is not None
    return parsed.published_split


@pytest.mark.parametrize(
    ("texts", "emotion"),
    [
        *(("0_1_1", "neutral"), ("0_64_64", "neutral"), ("0_65_65", "happiness")),
        *(("0_73_73", "anger"), ("0_86_86", "sadness"), ("0_87_94", "contempt")),
        *(("2_102_102", "surprise"), ("0_103_103", "fear"), ("0_118_118", "disgust")),
        *(("0_119_119", ""), ("0_57_72", ""), ("1_3_3", "")),
    ],
)
def test_the_name_of_a_recording_determines_speaker_and_emotion(texts: str, emotion: str) -> None:
    name = BeatName.parse(f"12_zhao_{texts}")
    assert name is not None
    assert (name.number, name.speaker, name.emotion) == (12, "zhao", emotion)
    for other in (f"zhao_{texts}", f"12_zhao_{texts}_mirrored", f"12_zhao_{texts}b", "12_zhao_0_1"):
        assert BeatName.parse(other) is None


def test_the_published_rule_splits_by_as_many_minutes_as_published_and_recordings_whole() -> None:
    speeches = Counter(published(f"2_scott_0_{text}_{text}") for text in range(1, 119))
    assert speeches == {"train": 88, "validation": 15, "test": 15}
    talks = [published(f"2_scott_1_{text}_{text}") for text in range(1, 13)]
    assert talks == ["test", *["train"] * 10, "validation"]
    there = [*range(1, 17), 65, 66, 73, 74, 81, 82, 87, 88, 95, 96, 103, 104, 111, 112, 118]
    splits = {text: published(f"5_stewart_0_{text}_{text}") for text in there}
    assert [text for text in there if splits[text] == "validation"] == [5, 6, 7, 8]
    tested = [1, 2, 3, 4, 65, 73, 81, 87, 95, 103, 111]
    assert [text for text in there if splits[text] == "test"] == tested
    others = ("12_zhao_2_1_1", "2_scott_0_1_8", "31_eve_0_1_1", "2_a_0_119_119")
    assert [published(name) for name in others] == [None] * 4
