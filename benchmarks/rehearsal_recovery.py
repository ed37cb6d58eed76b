"""How well the analysis recovers the truth of many rehearsals of the pairwise template.

``python -m benchmarks.rehearsal_recovery`` simulates rehearsals of the template with its own
population, without a server, and prints the analysis' results; ``--write docs/rehearsal.md`` puts
the tables into that page. The numbers are the same every time.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import click
import numpy as np
import pandas as pd

from analysis.answers.cells import Cells
from analysis.answers.exclusion_rules import KnownFacts
from analysis.answers.participants import LeftOut, leave_out
from analysis.answers.reading import Order, answers_in
from analysis.answers.table import PAIRWISE, AnswerTable
from analysis.results.known_values import KnownValue
from analysis.results.mixed_models import sided
from analysis.results.preference import win_share
from motion.segment import EMOTIONS, Segment
from studyapp.rehearsal.simulation.population import (
    DESCRIPTIONS,
    KINDS,
    Kind,
    Population,
    default_population,
)
from studyapp.rehearsal.simulation.raters import Rater, judge
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.conditions import comparison_name
from studyapp.study.settings.reading import parse_text
from studyapp.study.study_file import render_template
from tools.markdown import write_part

REHEARSALS: Final = 200
SEGMENTS_EACH: Final = 3
"""Segments of each emotion, as in AMUSE's study."""


@dataclass(frozen=True, kw_only=True)
class Simulated:
    """What a rehearsal stores.

    Attributes
    ----------
    table : AnswerTable
        All answers.
    known : dict of str to KnownFacts
        The study's records of each participant.
    kinds : dict of str to Kind
        Each participant's kind of rater.
    """

    table: AnswerTable
    known: dict[str, KnownFacts]
    kinds: dict[str, Kind]


@dataclass
class Tally:
    """Results for one question over all rehearsals.

    Attributes
    ----------
    truth, found, widths : list of float
        By rehearsal: the true share, the estimated share, and half the width of its interval.
    inside, right, wrong : int
        How many intervals contain the truth, and how many exclude one half on the right and on the
        wrong side.
    """

    truth: list[float] = field(default_factory=list)
    found: list[float] = field(default_factory=list)
    widths: list[float] = field(default_factory=list)
    inside: int = 0
    right: int = 0
    wrong: int = 0

    def add(self, truth: float, found: float, low: float, high: float) -> None:
        """Add one rehearsal."""
        self.truth.append(truth)
        self.found.append(found)
        self.widths.append((high - low) / 2)
        self.inside += low <= truth <= high
        side = 1 if low > 0.5 else -1 if high < 0.5 else 0
        self.right += side * (truth - 0.5) > 0
        self.wrong += side * (truth - 0.5) < 0


def template_study() -> tuple[PairwiseStudy, tuple[Segment, ...]]:
    """Return the pairwise template, with as many segments as its published design has."""
    text = render_template("pairwise")
    study = parse_text(text, where="pairwise.toml")
    if not isinstance(study, PairwiseStudy):
        raise TypeError("the template has another protocol")
    return study, tuple(
        Segment(
            name=f"{emotion}-{number}",
            wav="speech.wav",
            start=0.0,
            end=8.0,
            speaker="speaker",
            emotion=emotion,
        )
        for emotion in EMOTIONS
        for number in range(SEGMENTS_EACH)
    )


def simulated(
    study: PairwiseStudy, segments: Sequence[Segment], population: Population, seed: int
) -> Simulated:
    """Return what a rehearsal stores; every place is offered again until somebody finishes."""
    rows: list[dict[str, str]] = []
    known: dict[str, KnownFacts] = {}
    kinds: dict[str, Kind] = {}
    for arm in study.arms:
        for number in range(arm.places):
            plan = study.plan(arm, number, segments)
            for rater in _holders(population, seed, f"{arm.name} {number}"):
                leaves_at = None if rater.returns else rater.leaves_at(len(plan))
                settled = len(plan) if leaves_at is None else leaves_at - 1
                failed: Counter[str] = Counter()
                for trial in plan[:settled]:
                    answers = judge(study, rater, trial).values
                    failed[trial.kind] += study.failed(trial, answers)
                    left, right = trial.conditions
                    rows.extend(
                        {
                            "participant": rater.name,
                            "segment": trial.segment.name,
                            "question": question,
                            "trial": str(trial.position),
                            "kind": trial.kind,
                            "left": left,
                            "right": right,
                            "response": str(value + 3),
                            "correct_side": {None: "", 1: "left", 2: "right"}[trial.expected],
                        }
                        for (question, _), value in answers.items()
                    )
                kinds[rater.name] = rater.kind
                known[rater.name] = KnownFacts(
                    trials=len(plan),
                    settled=settled,
                    failed_catch=failed["catch"] if study.catch.trials else None,
                    failed_attention=failed["attention"] if study.attention.trials else None,
                )
    cells = Cells(
        path=Path("answers.csv"),
        rows=pd.DataFrame(rows, dtype=str),
        numbers=pd.RangeIndex(len(rows)) + 2,
        ignored=(),
    )
    order = Order(
        conditions=(study.reference, *study.others),
        questions=tuple(question.name for question in study.questions),
    )
    return Simulated(table=answers_in(cells, PAIRWISE, order), known=known, kinds=kinds)


def _holders(population: Population, seed: int, place: str) -> Iterator[Rater]:
    """Yield a place's holders in order, until somebody finishes."""
    name, again = place, 0
    while True:
        rater = Rater(population=population, seed=seed, name=name)
        yield rater
        if rater.kind != "dropping_out":
            return
        again += 1
        name = f"{place} again {again}"


def measure(rehearsals: int = REHEARSALS) -> list[str]:
    """Return the lines of the tables over `rehearsals`."""
    study, segments = template_study()
    population = default_population(study)
    kept: dict[str, Tally] = {}
    everybody: dict[str, Tally] = {}
    came: Counter[Kind] = Counter()
    silent: Counter[Kind] = Counter()
    removed: Counter[tuple[Kind, str]] = Counter()
    for seed in range(rehearsals):
        made = simulated(study, segments, population, seed)
        rules = [each.to_rule() for each in study.settled_exclusions]
        left_out = leave_out(made.table, rules, known=made.known)
        truth = expectations(study, segments, population=population, seed=seed)
        for entry in truth:
            for tallies, answers in ((kept, left_out.analysed), (everybody, left_out.everyone)):
                add_share(tallies.setdefault(entry.question, Tally()), study, answers, entry)
        answered = set(made.table.participants)
        came.update(made.kinds.values())
        silent.update(kind for who, kind in made.kinds.items() if who not in answered)
        removed.update(_removed(made, left_out))
    return [
        f"{rehearsals} rehearsals of the pairwise template: {study.arms[0].places} participants "
        f"for its comparison of `{study.reference}` with `{study.others[0]}`, {len(segments)} "
        f"segments, {study.trials} analysed pairs each, its own population and rules.",
        "",
        "| question | participants | true value | found | ± half interval | contains the true "
        "value | better one found | worse one found |",
        "|---|---|--:|--:|--:|--:|--:|--:|",
        *(_question_line(name, "after exclusions", kept[name]) for name in kept),
        *(_question_line(name, "everybody", everybody[name]) for name in everybody),
        "",
        "| kind | | came, a rehearsal | left out by `catch` | by `incomplete` | no answer "
        "| analysed |",
        "|---|---|--:|--:|--:|--:|--:|",
        *(
            _kind_line(kind, came[kind], removed, silent[kind], rehearsals)
            for kind in reversed(KINDS)
            if came[kind]
        ),
    ]


def _removed(made: Simulated, left_out: LeftOut) -> Iterator[tuple[Kind, str]]:
    for who, place in left_out.removed_by.items():
        yield made.kinds[who], left_out.rules[place].rule


def add_share(tally: Tally, study: PairwiseStudy, answers: pd.DataFrame, entry: KnownValue) -> None:
    """Add the reference's win share in the comparison and question that `entry` is about."""
    own = answers[answers["question"] == entry.question]
    (other,) = (o for o in study.others if comparison_name(study.reference, o) == entry.about)
    own = own[(own["left"] == other) | (own["right"] == other)]
    of_reference = (own["right"] == study.reference).to_numpy(bool)
    share = win_share(replace(sided(own), on_right=of_reference))
    tally.add(entry.value, share.estimate, share.low, share.high)


def _question_line(name: str, who: str, tally: Tally) -> str:
    count = len(tally.found)
    return (
        f"| {name} | {who} | {np.mean(tally.truth):.3f} | {np.mean(tally.found):.3f} "
        f"| {np.mean(tally.widths):.3f} | {tally.inside / count:.1%} | {tally.right / count:.1%} "
        f"| {tally.wrong / count:.1%} |"
    )


def _kind_line(
    kind: Kind,
    came: int,
    removed: Counter[tuple[Kind, str]],
    silent: int,
    rehearsals: int,
) -> str:
    catch, incomplete = removed[kind, "catch"], removed[kind, "incomplete"]
    analysed = came - catch - incomplete - silent
    return (
        f"| {kind.replace('_', ' ')} | {DESCRIPTIONS[kind]} | {came / rehearsals:.2f} "
        f"| {catch / came:.1%} | {incomplete / came:.1%} | {silent / came:.1%} "
        f"| {analysed / came:.1%} |"
    )


@click.command()
@click.option("--rehearsals", type=click.IntRange(1), default=REHEARSALS, show_default=True)
@click.option(
    "--write",
    "page",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="A page whose tables are replaced.",
)
def main(rehearsals: int, page: Path | None) -> None:
    """Print how well rehearsals of the pairwise template recover the truth."""
    lines = "\n".join(measure(rehearsals))
    click.echo(lines)
    if page is not None:
        write_part(page, "measured", lines)


if __name__ == "__main__":
    main()
