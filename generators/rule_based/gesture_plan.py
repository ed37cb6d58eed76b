"""The plan of gestures: accents, forms, hands, and times of phases.

A gesture has a preparation, a stroke, a hold and, unless the next one follows at once, a
retraction (Kendon 1980; McNeill 1992, ch. 3). The stroke ends at the accent, which is the time of a
beat's apex in speech (Leonard & Cummins 2011; Loehr 2012): 30 ms before the syllable's loudest
moment, after its onset.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from generators.rule_based.vocabulary import FORMS, GestureForm, GestureManner
from motion.arrays import Floats, Indices
from motion.prosody import Prosody

HANDS: Final = ("left", "right")

_PREPARATION: Final = 0.5
_RECOIL: Final = 0.32
_STROKE: Final = 0.26
_SHORTEST_HOLD: Final = 0.06
_AHEAD_OF_PEAK: Final = 0.03
_RETRACTION: Final = 0.85
_WORTH_RETRACTING: Final = 1.1
_QUICKEST_START: Final = 0.3
_SYLLABLE_REACH: Final = 0.12
_UNIT_GAP: Final = 1.6
_LONGEST_UNIT: Final = 3
_FORM_CHANGES: Final = 0.4
_STRONG_HAND: Final = 0.65


@dataclass(frozen=True, kw_only=True)
class Gesture:
    """One gesture up to the end of its stroke.

    Attributes
    ----------
    form : GestureForm
        The form.
    hands : tuple of str
        ``left``, ``right`` or both.
    begin : float
        Start of the preparation, in seconds.
    stroke : float
        End of the preparation and start of the stroke, in seconds.
    apex : float
        End of the stroke and start of the hold, at the accent, in seconds.
    hold : float
        Duration of the hold if nothing follows, in seconds.
    strength : float
        Prominence of the accent, in (0, 1].
    """

    form: GestureForm
    hands: tuple[str, ...]
    begin: float
    stroke: float
    apex: float
    hold: float
    strength: float


@dataclass(frozen=True, kw_only=True)
class Ending:
    """The end of a gesture of one hand.

    Attributes
    ----------
    release : float
        End of the hold, in seconds.
    rest : float or None
        End of the retraction, in seconds; None if the hand's next gesture starts from the hold.
    """

    release: float
    rest: float | None


def plan_gestures(
    prosody: Prosody, manner: GestureManner, rng: np.random.Generator
) -> tuple[Gesture, ...]:
    """Return the gestures that go with the accents of `prosody`.

    Parameters
    ----------
    prosody : Prosody
    manner : GestureManner
        The emotion's gesture parameters.
    rng : numpy.random.Generator
        Chooses forms and hands.

    Returns
    -------
    tuple of Gesture
        Gestures in time order; the phases of one hand do not overlap. Empty without accents.
    """
    picked = _pick_accents(prosody, manner.least_gap)
    strong_hand = HANDS[int(rng.random() < 0.7)]
    gestures: list[Gesture] = []
    for unit in _units(prosody.accents[picked], manner.tempo):
        last = gestures[-1].form if gestures else None
        form = _choose_form(manner, rng, unlike=last)
        hands = _choose_hands(form, manner, strong_hand, rng)
        for position, accent in enumerate(unit):
            apex = accent - _AHEAD_OF_PEAK
            if position and rng.random() < _FORM_CHANGES:
                form = _choose_form(manner, rng, unlike=form, hand_count=len(hands))
            earlier = _latest_of(gestures, hands)
            free = 0.0 if earlier is None else earlier.apex + _SHORTEST_HOLD
            begin, stroke = _approach(apex, free, bool(position), manner.tempo, rng)
            stroke = _on_syllable(stroke, begin, apex, prosody.syllables)
            gestures.append(
                Gesture(
                    form=form,
                    hands=hands,
                    begin=begin,
                    stroke=stroke,
                    apex=apex,
                    hold=manner.longest_hold * rng.uniform(0.4, 1.0),
                    strength=float(np.interp(accent, prosody.accents, prosody.prominence)),
                )
            )
    return tuple(gestures)


def _on_syllable(stroke: float, begin: float, apex: float, syllables: Floats) -> float:
    """Return the start of the stroke, moved to a nearby syllable if there is one.

    Hands are in time with the voice at the start of a stroke, too, not only at its end.
    """
    earliest = max(stroke - _SYLLABLE_REACH, begin + (stroke - begin) / 2)
    latest = min(stroke + _SYLLABLE_REACH, apex - (apex - stroke) / 2)
    moments = syllables - _AHEAD_OF_PEAK
    near = moments[(moments >= earliest) & (moments <= latest)]
    return float(near[np.argmin(np.abs(near - stroke))]) if len(near) else stroke


def endings(gestures: Sequence[Gesture], tempo: float) -> tuple[Ending, ...]:
    """Return the end of each gesture of one hand.

    Parameters
    ----------
    gestures : sequence of Gesture
        Gestures of one hand, in time order.
    tempo : float
        Speed of the retraction relative to a neutral speaker.
    """
    endings: list[Ending] = []
    for number, gesture in enumerate(gestures):
        release = gesture.apex + gesture.hold
        following = gestures[number + 1].begin if number + 1 < len(gestures) else np.inf
        room = following - release
        if room < _WORTH_RETRACTING:
            endings.append(Ending(release=following, rest=None))
        else:
            endings.append(Ending(release=release, rest=release + min(_RETRACTION / tempo, room)))
    return tuple(endings)


def _pick_accents(prosody: Prosody, least_gap: float) -> Indices:
    """Return the strongest accents that are at least `least_gap` seconds apart, in time order."""
    picked: list[int] = []
    for accent in np.argsort(-prosody.prominence, kind="stable"):
        time = prosody.accents[accent]
        far_enough = all(abs(time - prosody.accents[other]) >= least_gap for other in picked)
        if far_enough and time >= _QUICKEST_START:
            picked.append(int(accent))
    return np.array(sorted(picked), dtype=np.intp)


def _units(apexes: Floats, tempo: float) -> list[list[float]]:
    """Group the apexes into units within which the hand does not return to rest."""
    units: list[list[float]] = []
    for apex in apexes.tolist():
        if units and apex - units[-1][-1] < _UNIT_GAP / tempo and len(units[-1]) < _LONGEST_UNIT:
            units[-1].append(apex)
        else:
            units.append([apex])
    return units


def _choose_form(
    manner: GestureManner,
    rng: np.random.Generator,
    *,
    unlike: GestureForm | None,
    hand_count: int | None = None,
) -> GestureForm:
    """Choose a form by the emotion's preferences, other than `unlike`, for `hand_count` hands."""
    usable = [
        (FORMS[name], preference)
        for name, preference in manner.forms.items()
        if hand_count is None
        or (FORMS[name].both_hands if hand_count == 2 else FORMS[name].one_hand)
    ]
    candidates = [item for item in usable if item[0] is not unlike] or usable
    preferences = np.array([preference for _, preference in candidates])
    choice = rng.choice(len(candidates), p=preferences / preferences.sum())
    return candidates[int(choice)][0]


def _choose_hands(
    form: GestureForm, manner: GestureManner, strong_hand: str, rng: np.random.Generator
) -> tuple[str, ...]:
    """Choose the hands that make `form`; the strong hand more often than the other."""
    both, strong = rng.random() < manner.both_hands, rng.random() < _STRONG_HAND
    if not form.one_hand or (form.both_hands and both):
        return HANDS
    return tuple(hand for hand in HANDS if (hand == strong_hand) == strong)


def _latest_of(gestures: Sequence[Gesture], hands: tuple[str, ...]) -> Gesture | None:
    """Return the last of `gestures` that shares a hand with `hands`."""
    shared = (gesture for gesture in reversed(gestures) if set(gesture.hands) & set(hands))
    return next(shared, None)


def _approach(
    apex: float, free: float, repeated: bool, tempo: float, rng: np.random.Generator
) -> tuple[float, float]:
    """Return the starts of preparation and stroke, shortened if the hand is free too late."""
    stroke = _STROKE / tempo * rng.uniform(0.85, 1.2)
    preparation = (_RECOIL if repeated else _PREPARATION) / tempo * rng.uniform(0.85, 1.2)
    squeeze = min(1.0, (apex - free) / (stroke + preparation))
    return apex - squeeze * (stroke + preparation), apex - squeeze * stroke
