from __future__ import annotations

import pytest

from motion.segment import EMOTIONS
from training.corpus.plan import SENTENCES, UNHEARD, passage


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_every_sentence_exists_once(emotion: str) -> None:
    sentences = [text for part in SENTENCES[emotion].values() for text in part]
    assert len(set(sentences)) == len(sentences) == 24


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_81_passages_differ_and_the_first_nine_share_no_sentence(emotion: str) -> None:
    assert len({passage(emotion, number) for number in range(81)}) == 81
    assert passage(emotion, 81) == passage(emotion, 0)
    told = "".join(passage(emotion, number) for number in range(9))
    assert all(
        told.count(text) <= 1
        for text in (text for part in SENTENCES[emotion].values() for text in part)
    )


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_what_is_kept_for_testing_is_heard_in_no_other_passage(emotion: str) -> None:
    kept = [text for part in SENTENCES[emotion].values() for text in part[-UNHEARD:]]
    told = "".join(passage(emotion, number) for number in range(81))
    assert not any(text in told for text in kept)
    unheard = {passage(emotion, number, unheard=True) for number in range(UNHEARD**2)}
    assert len(unheard) == UNHEARD**2
    assert all(any(text in one for text in kept) for one in unheard)
