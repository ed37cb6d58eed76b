"""Participants who answer a whole study at random, without the web server."""

from pathlib import Path

import numpy as np

from studyapp.session.trials import ShownTrial
from tests.support.studies.taking_part_steps import Participant, taking_part


def answer_study(
    folder: Path, *, people: int, seed: int = 1, stop_after: int | None = None
) -> None:
    """Let `people` take part in the study in `folder`; the last one stops after some trials."""
    chance = np.random.default_rng(seed)
    with taking_part(folder) as first:
        for number in range(people):
            trials = stop_after if number == people - 1 else None
            _take(first.another().enrol(f"visit{number}").begin(), chance, trials)


def _take(participant: Participant, chance: np.random.Generator, trials: int | None) -> None:
    while participant.look().trial is not None and trials != 0:
        shown = participant.watch_all()
        participant.clock.advance(seconds=10)
        participant.answer(shown.token, _answers(shown, chance))
        trials = None if trials is None else trials - 1


def _answers(shown: ShownTrial, chance: np.random.Generator) -> dict[str, str]:
    """Return answers by chance: of what is ranked, an order for each question."""
    questions = dict.fromkeys(ask.question for ask in shown.asks)
    orders = {
        name: iter(chance.permutation(len(shown.asks) // len(questions))) for name in questions
    }
    ranked = all(
        ask.stimulus is not None and len(ask.values) * len(questions) == len(shown.asks)
        for ask in shown.asks
    )
    return {
        ask.field: str(
            int(next(orders[ask.question])) + 1 if ranked else int(chance.choice(ask.values))
        )
        for ask in shown.asks
    }
