"""The plan of gestures: accents, forms, hands, and times of phases.

A gesture has a preparation, a stroke, a hold and, unless the next one follows at once, a
retraction (Kendon 1980; McNeill 1992, ch. 3). The stroke ends at the accent, where the farthest
point of a beat lies in speech (Leonard & Cummins 2011; Loehr 2012): 30 ms ahead of the syllable's
loudest moment, between its onset and that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.vocabulary import FORMS, GestureForm, GestureManner
from motion.prosody import Prosody

FloatArray = NDArray[np.float64]

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
        When the preparation begins, in seconds.
    stroke : float
        When preparation ends and the stroke begins.
    apex : float
        When the stroke ends and the hold begins: at the accent.
    hold : float
        Seconds that the hand would stay if nothing followed.
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
        When the hold ends, in seconds.
    rest : float or None
        When the retraction ends; None where the hand's next gesture begins out of the hold.
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
        In time order; the phases of one hand do not overlap. Empty where nothing is accented.
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


def _on_syllable(stroke: float, begin: float, apex: float, syllables: FloatArray) -> float:
    """Return the stroke's beginning moved onto a syllable near it, where there is one.

    Hands turn with the voice at the top of a beat too, not only at its end.
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
        Those of one hand, in time order.
    tempo : float
        Speed of the retraction against an unmoved speaker's.
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


def _pick_accents(prosody: Prosody, least_gap: float) -> NDArray[np.intp]:
    """Return the strongest accents that lie at least `least_gap` seconds apart, in time order."""
    picked: list[int] = []
    for accent in np.argsort(-prosody.prominence, kind="stable"):
        time = prosody.accents[accent]
        far_enough = all(abs(time - prosody.accents[other]) >= least_gap for other in picked)
        if far_enough and time >= _QUICKEST_START:
            picked.append(int(accent))
    return np.array(sorted(picked), dtype=np.intp)


def _units(apexes: FloatArray, tempo: float) -> list[list[float]]:
    """Return the apexes in runs that one hand makes without going back to rest."""
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
    """Return a form the emotion likes, another than `unlike`, for `hand_count` hands if given."""
    usable = [
        (FORMS[name], liking)
        for name, liking in manner.forms.items()
        if hand_count is None
        or (FORMS[name].both_hands if hand_count == 2 else FORMS[name].one_hand)
    ]
    candidates = [(form, liking) for form, liking in usable if form is not unlike] or usable
    liking = np.array([weight for _, weight in candidates])
    return candidates[int(rng.choice(len(candidates), p=liking / liking.sum()))][0]


def _choose_hands(
    form: GestureForm, manner: GestureManner, strong_hand: str, rng: np.random.Generator
) -> tuple[str, ...]:
    """Return the hands to make `form` with; the strong hand more often than the other."""
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
    """Return when preparation and stroke begin, squeezed where the hand is free late."""
    stroke = _STROKE / tempo * rng.uniform(0.85, 1.2)
    preparation = (_RECOIL if repeated else _PREPARATION) / tempo * rng.uniform(0.85, 1.2)
    squeeze = min(1.0, (apex - free) / (stroke + preparation))
    return apex - squeeze * (stroke + preparation), apex - squeeze * stroke
