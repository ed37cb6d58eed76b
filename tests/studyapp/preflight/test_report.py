from __future__ import annotations

from studyapp.preflight.finding import Finding, record, summed_up, told


def gone(what: str, *, where: str = "", remedy: str = "Bring it") -> Finding:
    return Finding(name="gone", severity="error", what=what, where=where, remedy=remedy)


def odd(what: str, *, where: str) -> Finding:
    return Finding(name="odd", severity="warning", what=what, where=where, remedy="Look at it")


def known(what: str, *, where: str = "") -> Finding:
    return Finding(name="known", severity="note", what=what, where=where, remedy="")


def lines(findings: list[Finding], *, everything: bool = False) -> str:
    return "\n".join(told(findings, everything=everything))


def test_a_finding_is_told_with_name_place_and_remedy() -> None:
    said = lines([gone("the video is gone", where="videos/a.mp4")])

    assert said.strip() == "error: gone\n  videos/a.mp4: the video is gone.\n  > Bring it."


def test_a_place_that_the_sentence_names_is_not_told_twice() -> None:
    assert lines([known("a.mp4 is known", where="a.mp4")]).count("a.mp4") == 1


def test_a_remedy_of_its_own_takes_the_place_of_the_kinds() -> None:
    said = lines([gone("x is gone", remedy="Draw it"), gone("y is gone")])

    assert "> Draw it." in said
    assert said.count("> ") == 2


def test_findings_of_one_kind_are_told_together_and_many_are_counted() -> None:
    many = [gone(f"video {number} is gone") for number in range(9)]

    said = lines([many[0], known("it is known"), *many[1:]])

    assert said.count("error: gone") == 1
    assert said.count("is gone.") == 3
    assert "and 6 more like these" in said
    assert said.count("> Bring it.") == 1
    assert lines(many, everything=True).count("is gone.") == 9


def test_a_record_counts_and_keeps_everything() -> None:
    made = record("mine", [gone("a"), odd("b", where="w"), known("c")])

    assert (made.errors, made.warnings, made.notes) == (1, 1, 1)
    assert [found.name for found in made.findings] == ["gone", "odd", "known"]
    assert made.findings[1].model_dump() == {
        "name": "odd", "severity": "warning", "where": "w", "what": "b", "remedy": "Look at it",
    }  # fmt: skip
    assert summed_up(made) == "1 error, 1 warning and 1 note"
    assert summed_up(record("mine", [])) == "nothing found"
