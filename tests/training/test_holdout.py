from __future__ import annotations

from training.holdout import held_out_recordings


def test_each_label_gives_up_its_share_and_keeps_one() -> None:
    recordings = [f"r{n}" for n in range(12)]
    labels = ["calm"] * 10 + ["rare", "rare"]
    kept_back = held_out_recordings(recordings, labels, share=0.2, seed=0)
    assert len(kept_back & set(recordings[:10])) == 2
    assert len(kept_back & set(recordings[10:])) == 1


def test_a_label_of_one_recording_stays_to_be_learned_from() -> None:
    assert held_out_recordings(["a", "b"], ["x", "y"], share=0.2, seed=0) == frozenset()
    assert held_out_recordings(["a", "a"], ["x", "x"], share=0.2, seed=0) == frozenset()


def test_the_clips_of_a_recording_are_kept_back_together() -> None:
    recordings = ["a"] * 5 + ["b"] * 5
    assert len(held_out_recordings(recordings, [""] * 10, share=0.5, seed=0)) == 1


def test_the_seed_decides_and_the_order_of_clips_does_not() -> None:
    recordings = [f"r{n}" for n in range(40)]
    labels = ["x"] * 40
    drawn = held_out_recordings(recordings, labels, share=0.2, seed=0)
    assert drawn == held_out_recordings(recordings[::-1], labels, share=0.2, seed=0)
    assert drawn != held_out_recordings(recordings, labels, share=0.2, seed=1)
