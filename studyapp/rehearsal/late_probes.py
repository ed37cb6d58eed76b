"""Bad submissions after the end, and in the name of somebody else: none may change anything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from threading import Event

import httpx

from studyapp.rehearsal.eyes import Eyes, FinishedSitting
from studyapp.rehearsal.forms import FormData
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.probes import Probe, Prober, as_data, other_answers
from studyapp.rehearsal.simulation.judgement import Judgement
from studyapp.rehearsal.visit import Visit
from studyapp.study.settings.study import Study


def probe_finished(client: httpx.Client, study: Study, eyes: Eyes) -> tuple[Probe, ...]:
    """Send what should be refused in the names of participants who have all finished or left.

    Parameters
    ----------
    client : httpx.Client
        Reaches the study's server.
    study : Study
        Knows what goes together.
    eyes : Eyes
        Tells what is stored; nobody else may be changing it meanwhile.

    Returns
    -------
    tuple of Probe
        What was tried: nothing where nobody has finished, and nothing in the name of others where
        only one has.

    Raises
    ------
    BrokenPageError
        If something bad was not refused, or changed what is stored.
    """
    finished = eyes.finished()[:2]
    if not finished:
        return ()
    own, *others = finished
    late = _Late(client=client, study=study, eyes=eyes)
    return (*late.after_the_end(own), *(probe for each in others for probe in late.of(own, each)))


@dataclass(frozen=True, kw_only=True)
class _Late:
    """Sends forms of pages that nobody is at any more."""

    client: httpx.Client
    study: Study
    eyes: Eyes

    def after_the_end(self, own: FinishedSitting) -> Iterator[Probe]:
        """Send in one's own name what comes too late."""
        good = self._answers(own)
        other = {**good, **as_data(other_answers(self._judgement(own)))}
        trouble = {"trial": [own.trial], "video": [own.video]}
        yield self._at(own, "answers").harmless("the last answers again after the end", good)
        yield self._at(own, "answers").refused("other answers after the end", other)
        yield self._at(own, "unplayable").refused("trouble after the end", trouble)
        yield self._at(own, f"watched/{own.video}").refused_report(
            "playing reported after the end", {"batch": 999, "intervals": [[0.0, 0.1]]}
        )
        yield self._at(own, "begin").harmless("beginning after the end", {})
        yield self._at(own, "withdraw").refused("withdrawing after the end", {})
        nobody = replace(own, token="0" * len(own.token))
        yield self._at(nobody, "answers").refused("answers of nobody", good)

    def of(self, own: FinishedSitting, other: FinishedSitting) -> Iterator[Probe]:
        """Mix what belongs to two people."""
        good = self._answers(own)
        foreign = {**good, "trial": [other.trial]}
        yield self._at(other, "answers").refused("answers at another's address", good)
        yield self._at(own, "answers").refused("answers to another's trial", foreign)
        yield self._at(own, "unplayable").refused(
            "trouble with another's video", {"trial": [own.trial], "video": [other.video]}
        )
        yield self._at(own, f"watched/{other.video}").refused_report(
            "playing reported of another's video", {"batch": 999, "intervals": [[0.0, 0.1]]}
        )

    def _at(self, sitting: FinishedSitting, step: str) -> Prober:
        address = f"/take/{sitting.token}/{step}"
        return Prober(
            visit=Visit(client=self.client, stop=Event(), speed=1.0),
            page=Page(address, ""),
            target=address,
            stored=self.eyes.everything,
        )

    def _judgement(self, sitting: FinishedSitting) -> Judgement:
        return Judgement(
            asks=self.study.asks(sitting.seen), values=sitting.values, reasons=sitting.reasons
        )

    def _answers(self, sitting: FinishedSitting) -> FormData:
        return {"trial": [sitting.trial], **as_data(self._judgement(sitting))}
