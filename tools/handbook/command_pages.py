"""The pages of ``docs/commands``: options from the command line's help, all else by hand.

A page has a block for its command and for each subcommand, between two marks. The blocks are
generated and the rest is kept. A command without a page gets one with empty headings, which the
tests do not accept.

``make pages`` brings all pages up to date.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import click

from motion.files import write_text
from studyapp.cli.main import group

_PROGRAM = "motionjury"

PAGES: Final = Path(__file__).resolve().parents[2] / "docs" / "commands"
INDEX: Final = "README"
HEADINGS: Final = ("What for", "Example", "What it writes", "What it refuses")
"""Handwritten headings of every page."""

_BLOCK: Final = re.compile(r"<!-- from the code: (?P<name>[^>]+?) -->\n.*?<!-- end -->", re.DOTALL)


def commands() -> dict[str, click.Context]:
    """Return every command as it is typed, such as ``recruit codes``, with its context.

    Returns
    -------
    dict of str to click.Context
        Sorted; subcommands follow their command.
    """
    top = click.Context(group, info_name=_PROGRAM, **group.context_settings)
    contexts: dict[str, click.Context] = {}
    for path, context in _below(group, top):
        contexts[" ".join(path)] = context
    return contexts


def _below(
    above: click.Group, context: click.Context, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], click.Context]]:
    for name in above.list_commands(context):
        command = above.get_command(context, name)
        if command is None or command.hidden:
            continue
        own_names = click.Context(command, info_name=name, parent=context)
        yield (*path, name), own_names
        if isinstance(command, click.Group):
            yield from _below(command, own_names, (*path, name))


def summary(context: click.Context) -> str:
    """Return the first sentence of a command's help."""
    return context.command.get_short_help_str(limit=1000)


def described(context: click.Context) -> str:
    """Return usage, description, arguments and options of a command, as Markdown."""
    command = context.command
    usage = " ".join([_typed(context), *command.collect_usage_pieces(context)])
    parts = [f"    {usage}", *_paragraphs(command.help or "")]
    if table := _options(context):
        parts.append("\n".join(table))
    return "\n\n".join(parts)


def _typed(context: click.Context) -> str:
    """Return the command with its parent commands and their arguments."""
    before = context.parent
    if before is None:
        return context.info_name or ""
    arguments = [
        param.make_metavar(before)
        for param in before.command.params
        if isinstance(param, click.Argument)
    ]
    return " ".join([_typed(before), *arguments, context.info_name or ""])


def _paragraphs(text: str) -> list[str]:
    return [" ".join(part.split()) for part in text.split("\n\n") if part.strip()]


def _options(context: click.Context) -> list[str]:
    rows = []
    for param in context.command.get_params(context):
        record = param.get_help_record(context)
        if not isinstance(param, click.Option) or record is None or "--help" in param.opts:
            continue
        names, meaning = (_cell(text) for text in record)
        rows.append(f"| `{names}` | {meaning.replace('<', '&lt;')} |")
    return ["| option | |", "|---|---|", *rows] if rows else []


def _cell(text: str) -> str:
    """Return text for a table's cell, on one line and with bars escaped."""
    return " ".join(text.split()).replace("|", "\\|")


def block(name: str, words: str) -> str:
    """Return a generated part of a page."""
    return f"<!-- from the code: {name} -->\n{words}\n<!-- end -->"


def blocks(page: str) -> dict[str, str]:
    """Return the generated parts of a page, marks included, by name."""
    return {contexts["name"]: contexts[0] for contexts in _BLOCK.finditer(page)}


def by_hand(page: str) -> str:
    """Return the handwritten text of a page."""
    return _BLOCK.sub("", page)


def pages(before: Mapping[str, str]) -> dict[str, str]:
    """Return every page up to date.

    Parameters
    ----------
    before : mapping of str to str
        The present pages by command, and `INDEX`.

    Returns
    -------
    dict of str to str
        A page for each command, and the index, without pages of removed commands.
    """
    every = commands()
    tops = [name for name in every if " " not in name]
    written = {name: _page(name, every, before.get(name, _empty(name))) for name in tops}
    table = ["| command | |", "|---|---|"]
    table += [f"| [`{name}`]({name}.md) | {summary(every[name])} |" for name in tops]
    index = before.get(INDEX, f"# The commands\n\n{block('all commands', '')}\n")
    return {**written, INDEX: _replaced(index, {"all commands": "\n".join(table)})}


def _page(name: str, every: Mapping[str, click.Context], before: str) -> str:
    own_names = [each for each in every if each.split()[0] == name]
    words = {f"motionjury {each}": described(every[each]) for each in own_names}
    old_blocks = blocks(before)
    new = "".join(
        f"## `{each}`\n\n{block(each, '')}\n\n" for each in words if each not in old_blocks
    )
    before = before.replace("## Example", f"{new}## Example", 1)
    return _replaced(before, words)


def _empty(name: str) -> str:
    parts = [f"# `motionjury {name}`", block(f"motionjury {name}", "")]
    parts += [f"## {heading}" for heading in HEADINGS]
    return "\n\n".join(parts) + "\n"


def _replaced(page: str, words: Mapping[str, str]) -> str:
    """Return `page` with its generated parts updated and blocks of removed commands deleted."""
    text = _BLOCK.sub(
        lambda contexts: (
            block(contexts["name"], words[contexts["name"]]) if contexts["name"] in words else ""
        ),
        page,
    )
    return re.sub(r"\n{3,}", "\n\n", text)


def main() -> None:
    """Bring the pages in ``docs/commands`` up to date."""
    PAGES.mkdir(parents=True, exist_ok=True)
    before = {path.stem: path.read_text(encoding="utf-8") for path in PAGES.glob("*.md")}
    for name, page in pages(before).items():
        if before.get(name) != page:
            write_text(PAGES / f"{name}.md", page)
            click.echo(f"Wrote {PAGES / f'{name}.md'}")
    for gone in sorted(set(before) - set(pages(before))):
        click.echo(f"{PAGES / f'{gone}.md'} belongs to no command: remove it.")


if __name__ == "__main__":
    main()
