from __future__ import annotations

import pytest

from studyapp.study.creation.commented_keys import stated

TEMPLATE = """\
kind = "pair"
# layout = "players"    # two of them

# Said of the table.
# [pay]
# amount = "2.50"       # each
# currency = "EUR"

# [other]
# amount = "1"
"""


def test_a_key_is_stated_and_what_is_said_behind_it_stays() -> None:
    assert 'layout = "side"    # two of them' in stated(TEMPLATE, {"layout": "side"})
    assert "layout = true    # two" in stated(TEMPLATE, {"layout": True})


def test_a_table_is_stated_with_the_keys_that_are_given_alone() -> None:
    said = stated(TEMPLATE, {"amount": "3.00"}, table="pay")

    assert '# Said of the table.\n[pay]\namount = "3.00"       # each\n# currency' in said
    assert '# [other]\n# amount = "1"' in said


def test_without_values_nothing_changes() -> None:
    assert stated(TEMPLATE, {}, table="pay") == TEMPLATE


def test_text_is_quoted() -> None:
    assert r'layout = "a \"b\" \\"' in stated(TEMPLATE, {"layout": 'a "b" \\'})


@pytest.mark.parametrize(("key", "table"), [("size", ""), ("size", "pay"), ("amount", "gone")])
def test_what_the_template_does_not_have_is_refused(key: str, table: str) -> None:
    with pytest.raises(ValueError, match="the template has no"):
        stated(TEMPLATE, {key: "1"}, table=table)
