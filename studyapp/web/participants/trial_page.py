"""What the page of a trial shows: its layout, its players, and the questions beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from studyapp.session.participation import ShownTrial, ShownVideo
from studyapp.study.settings.study import Study
from studyapp.web.language import _
from studyapp.web.participants.wording import AskedQuestion, asked_questions, letter

Layout = Literal["composed", "pair", "rating", "ranking"]
"""One video with both sides; two players; players with questions under each; cards to order."""


@dataclass(frozen=True, kw_only=True)
class Player:
    """One video of the page with its label.

    Attributes
    ----------
    label : str
        A, B, … or Reference; empty for a composed pair, whose picture holds its labels.
    questions : tuple of AskedQuestion
        Those about this video alone.
    """

    label: str
    video: ShownVideo
    questions: tuple[AskedQuestion, ...]


@dataclass(frozen=True, kw_only=True)
class TrialPage:
    """A trial as its page shows it.

    Attributes
    ----------
    reference : Player or None
        What is shown apart and not judged.
    players : tuple of Player
        What is judged, in order.
    questions : tuple of AskedQuestion
        Those about the whole trial.
    """

    layout: Layout
    reference: Player | None
    players: tuple[Player, ...]
    questions: tuple[AskedQuestion, ...]

    @property
    def boxes(self) -> int:
        """How many videos stand beside each other."""
        return len(self.players) + (self.reference is not None)

    @property
    def muted(self) -> bool:
        """Whether all videos are to be seen without sound."""
        return all(player.video.muted for player in self.players)


def trial_page(study: Study, trial: ShownTrial) -> TrialPage:
    """Return what the page of `trial` shows."""
    questions = asked_questions(study, trial)
    players = [
        Player(
            label=_label(video),
            video=video,
            questions=tuple(asked for asked in questions if (asked.stimulus,) == video.shows),
        )
        for video in trial.videos
    ]
    return TrialPage(
        layout=_layout(questions, players),
        reference=next((player for player in players if player.video.shows == (0,)), None),
        players=tuple(player for player in players if player.video.shows != (0,)),
        questions=tuple(asked for asked in questions if asked.stimulus is None),
    )


def _label(video: ShownVideo) -> str:
    if video.shows == (0,):
        return _("Reference")
    return letter(video.shows[0]) if len(video.shows) == 1 else ""


def _layout(questions: list[AskedQuestion], players: list[Player]) -> Layout:
    if any(not player.label for player in players):
        return "composed"
    if any(asked.widget == "ranking" for asked in questions):
        return "ranking"
    return "rating" if any(asked.stimulus for asked in questions) else "pair"
