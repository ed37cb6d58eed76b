"""The measurements of every condition, and the conclusions from them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from analysis.metrics.scores import StudyMetrics
from benchmarks.learned_motion.compared_study import RULE_BASED, UNTRAINED
from benchmarks.learned_motion.editing import Edited
from benchmarks.learned_motion.following import (
    MEASURES,
    Followed,
    MeanFollowed,
    Speech,
    follow,
    mean_followed,
)
from generators.controls import assign_partners
from motion.formats import read_clip
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import GROUND_TRUTH


@dataclass(frozen=True, kw_only=True)
class Followings:
    """How well the clips of one condition follow speech, by measure.

    Attributes
    ----------
    own, swapped : mapping of str to MeanFollowed
        With their own speech, and with that of another take.
    """

    own: Mapping[str, MeanFollowed]
    swapped: Mapping[str, MeanFollowed]


def followings(
    folder: StudyFolder,
    conditions: Iterable[str],
    speech: Mapping[str, Speech],
    spoken: Mapping[str, str],
    *,
    seed: int,
) -> dict[str, Followings]:
    """Return how well each condition follows speech, its own and another's.

    Both are measured over the same frames of each clip, up to the end of the shorter speech.
    """
    swap = assign_partners([one for one in folder.segments() if one.name in speech], seed)
    scores_of_system = {}
    for condition in conditions:
        own: dict[str, Followed] = {}
        swapped: dict[str, Followed] = {}
        for take, other in swap.items():
            frames = min(len(speech[take]), len(speech[other]))
            clip = read_clip(folder.clip(condition, take)).frames(slice(0, frames))
            own[take] = follow(clip, speech[take])
            swapped[take] = follow(clip, speech[other])
        scores_of_system[condition] = Followings(
            own={name: mean_followed(own, spoken, name) for name in MEASURES},
            swapped={name: mean_followed(swapped, spoken, name) for name in MEASURES},
        )
    return scores_of_system


SIDES: Final = ("own", "swapped")


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """A requirement for trained networks, and whether they meet it.

    Attributes
    ----------
    claim : str
        The requirement.
    holds : bool
        Whether all trained networks meet it.
    evidence : str
        The numbers.
    """

    claim: str
    holds: bool
    evidence: str


def verdicts(
    distances: Mapping[str, float],
    scores_of_system: Mapping[str, Followings],
    trained: Sequence[str],
) -> list[Verdict]:
    """Return the claims about trained networks, and whether all of them hold.

    Parameters
    ----------
    distances : mapping of condition to float
        FGD of each condition.
    scores_of_system : mapping of condition to Followings
        How well each condition follows speech.
    trained : sequence of str
        Conditions of trained networks.
    """
    scores = ", ".join(f"{distances[name]:.3g}" for name in trained)
    judged = [
        Verdict(
            claim="FGD is at most half that of the untrained network",
            holds=all(distances[name] <= distances[UNTRAINED] / 2 for name in trained),
            evidence=f"{scores} beside {distances[UNTRAINED]:.3g}",
        ),
        Verdict(
            claim="FGD is below that of `rule_based`",
            holds=all(distances[name] < distances[RULE_BASED] for name in trained),
            evidence=f"{scores} beside {distances[RULE_BASED]:.3g}",
        ),
    ]
    for measure, called in (
        ("wrist_speed", "wrists follow the known process"),
        ("beats", "beat alignment is above chance"),
        ("strokes", "stroke alignment is above chance"),
    ):
        mine = [scores_of_system[name].own[measure] for name in trained]
        others = [scores_of_system[name].swapped[measure] for name in trained]
        noise = scores_of_system[GROUND_TRUTH].swapped[measure]
        judged.append(
            Verdict(
                claim=f"{called} with its own speech",
                holds=all(one.low > max(0, noise.high) for one in mine),
                evidence=f"{', '.join(written(one) for one in mine)}; recorded motion: "
                f"{written(scores_of_system[GROUND_TRUTH].own[measure])}",
            )
        )
        judged.append(
            Verdict(
                claim=f"{called} no more than noise when the speech is swapped",
                holds=all(one.low <= max(0, noise.high) for one in others),
                evidence=f"{', '.join(written(one) for one in others)}; noise, as recorded motion "
                f"with swapped speech: {written(noise)}",
            )
        )
    own, swapped = (
        [getattr(scores_of_system[name], side)["strokes"] for name in trained] for side in SIDES
    )
    pairs = [
        f"{written(one)} beside {written(other)}" for one, other in zip(own, swapped, strict=True)
    ]
    judged.append(
        Verdict(
            claim="stroke alignment with its own speech is clearly above that with swapped speech",
            holds=all(one.low > other.high for one, other in zip(own, swapped, strict=True)),
            evidence=", ".join(pairs),
        )
    )
    return judged


def edit_verdicts(way: str, edited: Sequence[Edited]) -> list[Verdict]:
    """Return the claims about edits of the emotion, given one `Edited` per trained network.

    `way` is how the emotion is given: `BY_NAME` or `BY_RECORDING`.
    """
    return [
        Verdict(
            claim=f"another emotion {way} is recognised in the motion in most edits",
            holds=all(one.accuracy > 0.5 for one in edited),
            evidence=", ".join(f"{one.accuracy:.3g}" for one in edited),
        ),
        Verdict(
            claim=f"{way}: nine tenths as many clips or more are taken for their speaker's",
            holds=all(one.speaker_after >= 0.9 * one.speaker_before for one in edited),
            evidence=", ".join(
                f"{one.speaker_after:.3g} beside {one.speaker_before:.3g}" for one in edited
            ),
        ),
        Verdict(
            claim=f"{way}: wrists move when they moved before the edit, correlation above 0.5",
            holds=all(one.speed > 0.5 for one in edited),
            evidence=", ".join(f"{one.speed:.3g}" for one in edited),
        ),
    ]


def written(value: MeanFollowed) -> str:
    """Return a mean with its interval."""
    return f"{value.mean:.3f} [{value.low:.3f}, {value.high:.3f}]" if value.clips else "–"


def score_of(metrics: StudyMetrics, condition: str, beginning: str) -> float:
    """Return a condition's score by the beginning of the metric's name; NaN if missing."""
    for score in metrics.conditions:
        if score.condition == condition and score.name.startswith(beginning):
            return score.value
    return float("nan")
