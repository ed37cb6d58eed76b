from dataclasses import replace

from analysis.report.wording import labelled
from analysis.results.known_values import KnownDifference, KnownValue
from analysis.stats.clustered_mean import Estimate
from studyapp.rehearsal.bookkeeping import Check, Person
from studyapp.rehearsal.recovered import KindRecovered, Recovery, kinds_recovered
from studyapp.rehearsal.recovery_page import recovery_lines, recovery_page, values_in_words
from studyapp.rehearsal.simulation.population import Kind, Population
from studyapp.rehearsal.simulation.raters import Rater

KNOWN = KnownValue(
    about="ours-theirs", question="fit", measure="win_share", value=0.6, on_these_segments=0.62
)
FOUND = Estimate(estimate=0.55, low=0.45, high=0.65, participants=25)
UNDECIDED = KnownDifference(
    part="",
    question="fit",
    measure="win_share",
    first="ours",
    second="theirs",
    truth=0.1,
    estimate=Estimate(estimate=0.05, low=-0.15, high=0.25, participants=25),
    decided=False,
)
RIGHT = Check(what="completed, says the report", happened=3, counted=3)
RECOVERY = Recovery(
    title="A study",
    labels={"ours": "Ours", "ours-theirs": "Ours against theirs"},
    values=((KNOWN, FOUND), (replace(KNOWN, question="emotion", value=0.9), FOUND)),
    differences=(UNDECIDED,),
    kinds=(),
    checks=(RIGHT,),
    rules=("failed more than 1 catch trial",),
)


def person(number: int, kind: Kind, *, completed: bool = True) -> Person:
    people = Population(quality={}, kinds={kind: 1.0})
    rater = Rater(population=people, seed=1, name=str(number))
    return Person(study_session=str(number), name=f"p{number}", rater=rater, completed=completed)


def kinds() -> tuple[KindRecovered, ...]:
    return kinds_recovered(
        [
            *(person(number, "attentive") for number in range(3)),
            *(person(number, "careless") for number in (3, 4)),
            *(person(number, "dropping_out", completed=False) for number in (5, 6)),
        ],
        analysed=["0", "1", "4"],
        removed_by={"2": "catch", "3": "catch", "5": "incomplete"},
    )


def test_a_design_that_cannot_answer_is_distinguished_from_bad_luck() -> None:
    unlucky = replace(UNDECIDED, truth=0.3)
    ranked = replace(
        UNDECIDED,
        measure="mean_rank",
        estimate=Estimate(estimate=0.05, participants=25, reason="too few ranks"),
    )
    wrong = replace(UNDECIDED, truth=-0.1, decided=True)

    _, signs, *lines = recovery_lines(
        replace(RECOVERY, differences=(UNDECIDED, unlucky, ranked, wrong))
    )

    assert signs == "4 comparisons: 1 found with the wrong sign and 3 undecided."
    assert lines[0].startswith("  Fit: Ours and theirs: the analysis finds +.05, but the true")
    assert (
        "the design cannot answer this question. With 25 participants, the interval is ±.20, but "
        "the true difference is +.10: see 'motionjury plan'" in lines[1]
    )
    assert "undecided this time" in lines[2]
    assert "undecided (too few ranks). The true difference is" in lines[3]


def test_each_kind_is_counted_as_excluded_missed_or_wrongly_excluded() -> None:
    found = {kind.kind: kind for kind in kinds()}
    attentive, careless, left = (found[kind] for kind in ("attentive", "careless", "dropping_out"))
    assert (attentive.came, attentive.analysed, attentive.wrongly_excluded) == (3, 2, 1)
    assert (careless.excluded_by, careless.missed) == ({"catch": 1}, 1)
    assert (left.completed, left.excluded, left.silent, left.missed) == (0, 1, 1, 0)
    *_, first, _, second, _ = recovery_lines(replace(RECOVERY, kinds=kinds()))
    assert first == (
        "Exclusion: of 4 who answered badly or left, 2 are excluded, 1 gave no answer and 1 is "
        "analysed anyway; of 3 others, 1 is wrongly excluded."
    )
    assert second == "  careless: 2 came, 1 analysed, 1 excluded by catch"


def test_misses_and_miscounts_are_reported_in_tables_and_page() -> None:
    miscounted = replace(RIGHT, what="left for good", counted=2)
    whole = replace(RECOVERY, kinds=kinds(), checks=(RIGHT, miscounted))

    _heading, rows = values_in_words(whole)
    lines = recovery_lines(whole)

    assert [row[-1] for row in rows] == ["inside", "outside"]
    assert "The true value is inside 1 of 2 intervals" in lines[0]
    assert "at least 1 interval would miss it in 10 of 100" in lines[0]
    assert "MISCOUNTED: left for good: 3, counted 2." in lines
    with labelled(RECOVERY.labels):
        page = recovery_page(whole)
    assert page.mark.startswith("Rehearsal")
    raters, bookkeeping = (section.tables[0] for section in page.sections[2:])
    by_catch = raters.header.index("excluded by catch")
    assert [row[by_catch].value for row in raters.rows] == [1, 0, 1]
    assert [row[-1].text for row in bookkeeping.rows] == ["yes", "NO"]
