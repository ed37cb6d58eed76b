from collections import Counter

import pytest

from motion.errors import InputError
from motion.segment import EMOTIONS
from training.corpus.plan import (
    MOST_RECORDINGS,
    RESERVED_SENTENCES,
    SENTENCES,
    CorpusRequest,
    passage,
    planned_takes,
)


def test_the_default_corpus_is_as_documented() -> None:
    takes = list(planned_takes(CorpusRequest()))
    assert len(takes) == 8 * 16 * 2
    assert Counter(take.emotion for take in takes) == dict.fromkeys(EMOTIONS, 32)
    assert Counter(take.split for take in takes) == {"train": 144, "validation": 12, "test": 100}
    texts = {take.text for take in takes if take.split == "train"}
    kinds = {
        (take.text in texts, take.unheard, take.held_out_speaker)
        for take in takes
        if take.split == "test"
    }
    assert {(True, False, False), (False, True, False)} <= kinds
    assert {held_out for *_, held_out in kinds} == {True, False}


def test_training_excludes_held_out_speakers_and_sentences() -> None:
    takes = list(planned_takes(CorpusRequest(speakers=10, sentences=24, takes=3)))
    learned = [take for take in takes if take.split != "test"]
    assert {take.speaker.number for take in learned} == set(range(1, 9))
    texts = {take.text for take in learned}
    assert not any(take.text in texts for take in takes if take.unheard)
    assert not any(take.unheard or take.held_out_speaker for take in learned)


def test_a_speakers_motion_does_not_depend_on_the_corpus_size() -> None:
    small, large = (
        {take.name: take for take in planned_takes(CorpusRequest(speakers=count))}
        for count in (4, 20)
    )
    name = "1_ada_0_65_65"
    assert small[name].speaker == large[name].speaker
    assert small[name].seed == large[name].seed


@pytest.mark.parametrize(
    ("numbers", "complaint"),
    [
        ({"speakers": 2, "held_out_speakers": 2}, "cannot be held out"),
        ({"sentences": 12}, "cannot be divided equally"),
        ({"sentences": 8 * MOST_RECORDINGS, "takes": 2}, "names do not suffice"),
        ({"sentences": 24, "shared_passages": True}, "at least 32"),
    ],
)
def test_a_corpus_that_cannot_be_made_is_refused(numbers: dict[str, int], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        CorpusRequest(**numbers)  # type: ignore[arg-type]  # of any field


def test_shared_passages_hold_out_the_same_texts_for_all_speakers() -> None:
    request = CorpusRequest(
        speakers=4, sentences=96, takes=1, held_out_speakers=1, shared_passages=True
    )
    takes = list(planned_takes(request))
    known = [take for take in takes if not take.held_out_speaker]
    splits: dict[str, set[str]] = {}
    for take in known:
        splits.setdefault(take.text, set()).add(take.split)
    assert all(len(result) == 1 for result in splits.values())
    assert Counter(take.split for take in known) == {
        "train": 8 * 8 * 3, "validation": 2 * 8 * 3, "test": 2 * 8 * 3
    }  # fmt: skip
    assert all(take.unheard == (take.split == "test") for take in known)
    assert {take.split for take in takes if take.held_out_speaker} == {"test"}


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_passages_differ_and_test_passages_share_no_sentence(emotion: str) -> None:
    passages = {passage(emotion, number) for number in range(81)}
    unheard = {passage(emotion, number, unheard=True) for number in range(RESERVED_SENTENCES**2)}
    assert (len(passages), len(unheard)) == (81, RESERVED_SENTENCES**2)
    reserved = [text for part in SENTENCES[emotion].values() for text in part[-RESERVED_SENTENCES:]]
    assert not any(text in told for text in reserved for told in passages)
    assert all(any(text in told for text in reserved) for told in unheard)
