"""A participant's hands that also send what should be refused, on every kind of page."""

from __future__ import annotations

from dataclasses import dataclass, field
from threading import Lock

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.form_probes import probe_form
from studyapp.rehearsal.forms import FormFields
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.participant import answer_trial
from studyapp.rehearsal.probes import Probe, probe_trial
from studyapp.rehearsal.simulation.judgement import Judgement
from studyapp.rehearsal.visit import Visit
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class Examiner:
    """Answers trials and fills in forms as other participants do, but tries bad ones before.

    Of the trials, the first of each part of the study is examined.

    Attributes
    ----------
    name : str
        What the recruiter calls the participant.
    study : Study
        Knows what goes together.
    eyes : Eyes
        Tells what is stored.
    probes : list of Probe
        What was tried.
    examined : set of str
        The parts whose first trial was answered.
    """

    name: str
    study: Study
    eyes: Eyes
    probes: list[Probe] = field(default_factory=list)
    examined: set[str] = field(default_factory=set)

    def answer(self, visit: Visit, page: Page, judgement: Judgement) -> Page:
        """Answer the trial of `page` and return the page that follows."""
        part = self.eyes.look(page).trial.part
        if part in self.examined:
            return answer_trial(visit, page, judgement)
        self.examined.add(part)
        following, probes = probe_trial(visit, page, judgement, study=self.study, eyes=self.eyes)
        self.probes.extend(probes)
        return following

    def fill(self, visit: Visit, page: Page, answers: FormFields) -> Page:
        """Fill in the form of `page` and return the page that follows."""
        following, probes = probe_form(
            visit, page, answers, study=self.study, eyes=self.eyes, name=self.name
        )
        self.probes.extend(probes)
        return following


@dataclass(frozen=True)
class Examiners:
    """Who of many participants tries bad submissions: one at a time, and another if that one left.

    Attributes
    ----------
    probes : list of Probe
        What all of them tried.
    """

    probes: list[Probe] = field(default_factory=list)
    _present: dict[str, Examiner] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock, repr=False)

    def one(self, name: str, study: Study, eyes: Eyes, *, may_begin: bool) -> Examiner | None:
        """Return the examiner that `name` is; None where somebody else is, or nobody is needed."""
        with self._lock:
            if may_begin and not self._present:
                self._present[name] = Examiner(
                    name=name, study=study, eyes=eyes, probes=self.probes
                )
            return self._present.get(name)

    def left(self, name: str) -> None:
        """Let somebody else examine if `name`, who has left for good, did."""
        with self._lock:
            self._present.pop(name, None)
