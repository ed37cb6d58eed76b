"""A participant's hands that also send what should be refused, on every kind of page."""

from __future__ import annotations

from dataclasses import dataclass, field

from studyapp.definition.study import Study
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.form_probes import probe_form
from studyapp.rehearsal.forms import FormFields
from studyapp.rehearsal.judgement import Judgement
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.participant import answer_trial
from studyapp.rehearsal.probes import Probe, probe_trial
from studyapp.rehearsal.visit import Visit


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
