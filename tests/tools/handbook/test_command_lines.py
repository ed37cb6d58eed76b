from pathlib import Path

import click
import pytest

from tools.handbook.command_lines import calls, check_call

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("docs/commands/*.md")])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_on_a_page_is_valid(page: Path) -> None:
    for words in calls(page.read_text(encoding="utf-8")):
        try:
            check_call(words)
        except click.UsageError as error:
            pytest.fail(f"motionjury {' '.join(words)}: {error.format_message()}")


@pytest.mark.parametrize(
    "call",
    [
        "dance my-study",
        "report my-study --loud",
        "init my-study --template dance",
        "recruit my-study create",
        "check one two",
    ],
)
def test_values_that_the_program_refuses_are_refused(call: str) -> None:
    with pytest.raises(click.UsageError):
        check_call(call.split())
