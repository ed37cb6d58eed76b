"""What every protocol promises to the rest of the house."""

from itertools import groupby, pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.segment import EMOTIONS, Segment
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.settings.reading import ALIASES, PROTOCOLS, parse_study
from studyapp.study.settings.study import Study
from studyapp.study.versioning import design_digest
from tests.studyapp.study.protocols.made_protocols import KEYS, in_order, make, obedient
from tests.support.studies.made_study import make_segments

SEGMENTS = make_segments(EMOTIONS * 2)
PROTOCOL_NAMES = st.sampled_from(sorted(KEYS))


@st.composite
def designs(draw: st.DrawFn) -> tuple[Study, tuple[Segment, ...], tuple[PlannedTrial, ...]]:
    """Return a study with catch trials and attention checks, its segments, and a place's trials."""
    protocol = draw(PROTOCOL_NAMES)
    catch = dict(KEYS[protocol].get("catch", {})) | {"trials": draw(st.integers(0, 3))}
    study = make(
        protocol,
        seed=draw(st.integers(0, 2**32 - 1)),
        catch=catch,
        attention={"trials": draw(st.integers(0, 3))},
    )
    segments = make_segments(draw(st.lists(st.sampled_from(EMOTIONS), min_size=2, max_size=20)))
    arm = draw(st.sampled_from(study.arms))
    return study, segments, study.plan(arm, draw(st.integers(0, 30)), segments)


@given(designs())
def test_extra_trials_are_spread_out_within_parts_and_never_first(design: Any) -> None:
    study, _, plan = design
    kinds = [trial.kind for trial in plan]
    order = [part for part, _ in groupby(trial.part for trial in plan)]

    assert [trial.position for trial in plan] == list(range(1, len(plan) + 1))
    assert kinds[0] in ("main", "practice")
    assert kinds.count("catch") == study.catch.trials
    assert kinds.count("attention") == study.attention.trials
    assert order == [part for part in study.parts if part in order] or order == [""]
    for part in order:
        extra = [
            trial.kind in ("catch", "attention")
            for trial in plan
            if trial.part == part and trial.kind != "practice"
        ]
        if sum(extra) <= extra.count(False):
            assert not any(one and other for one, other in pairwise(extra))


@given(designs())
def test_every_shown_video_is_prepared(design: Any) -> None:
    study, segments, plan = design
    contents = list(study.contents(segments))

    assert len(set(contents)) == len(contents)
    shown = {video for trial in plan for video in trial.videos}
    shown |= {(trial.reference,) for trial in plan if trial.reference is not None}
    assert shown <= set(contents)


@given(designs())
def test_kinds_of_trials_in_a_part_differ_only_in_content(design: Any) -> None:
    study, _, plan = design
    looks: dict[str, set[tuple[int, int, bool]]] = {}
    for trial in plan:
        assert trial.kind == "catch" or set(trial.conditions) <= set(study.conditions)
        look = (len(trial.videos), len(trial.stimuli), trial.reference is not None)
        looks.setdefault(trial.part, set()).add(look)

    assert all(len(different) == 1 for different in looks.values())


@given(designs())
def test_every_question_has_its_own_field_and_choices(design: Any) -> None:
    study, _, plan = design

    for trial in plan:
        asks = study.asks(trial)
        shared = {(ask.question, ask.reasons_field) for ask in asks if ask.shares_reasons}
        own = [ask.reasons_field for ask in asks if not ask.shares_reasons]
        fields = [*(ask.field for ask in asks), *own, *(field for _, field in shared)]
        assert asks
        assert len(set(fields)) == len(fields)
        assert len(shared) == len({question for question, _ in shared})
        assert all(len(ask.values) > 1 for ask in asks)


@given(designs(), st.randoms())
def test_a_complete_answer_is_valid_and_fails_no_ordinary_trial(design: Any, chance: Any) -> None:
    study, _, plan = design

    for trial in plan:
        order = list(range(1, len(trial.conditions) + 1))
        chance.shuffle(order)
        answers = in_order(study, trial, order)
        assert study.problem(trial, answers) is None
        if trial.kind not in ("catch", "attention"):
            assert not study.failed(trial, answers)


@given(designs())
def test_seeing_the_flaw_decides_a_catch_trial(design: Any) -> None:
    study, _, plan = design

    for trial in plan:
        if trial.kind == "catch":
            flawed = 1 + trial.conditions.index(study.catch.condition)
            assert trial.conditions[trial.expected - 1] == study.catch_against
            order = [n for n in range(1, len(trial.conditions) + 1) if n != flawed]
            assert not study.failed(trial, in_order(study, trial, [*order, flawed]))
            assert study.failed(trial, in_order(study, trial, [flawed, *order]))


@given(designs())
def test_following_the_instruction_passes_an_attention_check(design: Any) -> None:
    study, _, plan = design

    for trial in plan:
        if trial.kind == "attention":
            answers = obedient(study, trial)
            assert study.problem(trial, answers) is None
            assert not study.failed(trial, answers)
            orders = ([1, 2, *range(3, 9)], [2, 1, *range(3, 9)])
            others = [in_order(study, trial, order[: len(trial.conditions)]) for order in orders]
            assert any(study.failed(trial, other) for other in others)


@pytest.mark.parametrize("protocol", sorted(KEYS))
def test_everything_but_operational_keys_is_part_of_the_design(protocol: str) -> None:
    def digest(**changes: Any) -> str:
        return design_digest(make(protocol, **changes), SEGMENTS, {})

    same = digest()
    page = {"consent": "You agree.", "contact": "lab@example.org", "payment": "5 EUR"}
    assert digest(open=False, lease_minutes=10, name="other", page=page) == same
    assert digest(attention={"trials": 0}) == same
    assert digest(watching={"megabytes_per_page": 5}) == same
    changed = [
        digest(seed=2),
        digest(freeze=["face"]),
        digest(attention={"trials": 1}),
        digest(watching={"coverage": 0.5}),
        digest(page={"consent": "You really agree."}),
        digest(page={"consent": "You agree.", "withdrawn": "kept"}),
        design_digest(make(protocol), SEGMENTS[:-1], {}),
    ]
    assert same not in changed
    assert len(set(changed)) == len(changed)


def test_an_arm_does_not_depend_on_other_comparisons() -> None:
    few: dict[str, dict[str, str]] = {name: {} for name in ("ours", "theirs")}
    before = make("pairwise", conditions=few, catch={"against": "ours"})
    after = make("pairwise", catch={"against": "ours"})

    arms = {arm.name: design_digest(after.design_of(arm), SEGMENTS, {}) for arm in after.arms}

    (arm,) = before.arms
    assert arms[arm.name] == design_digest(before.design_of(arm), SEGMENTS, {})
    assert len(set(arms.values())) == 3


@pytest.mark.parametrize(("alias", "protocol"), ALIASES.items())
def test_a_papers_name_selects_its_protocol(alias: str, protocol: str) -> None:
    named = make(protocol)
    keys = named.model_dump(exclude_unset=True) | {"protocol": alias}

    study = parse_study(keys, where="test")

    assert type(study) is PROTOCOLS[protocol]
    assert design_digest(study, SEGMENTS, {}) == design_digest(named, SEGMENTS, {})
