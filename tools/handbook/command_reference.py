"""What the command line says of itself, as Markdown."""

from __future__ import annotations

from collections.abc import Iterator

import click

from studyapp.cli.main import group

_PROGRAM = "motionjury"


def commands() -> dict[str, click.Context]:
    """Return every command as it is typed, such as ``recruit codes``, with its context.

    Returns
    -------
    dict of str to click.Context
        Sorted; subcommands come right behind the command that they belong to.
    """
    top = click.Context(group, info_name=_PROGRAM)
    found: dict[str, click.Context] = {}
    for path, context in _below(group, top):
        found[" ".join(path)] = context
    return found


def _below(
    above: click.Group, context: click.Context, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], click.Context]]:
    for name in above.list_commands(context):
        command = above.get_command(context, name)
        if command is None or command.hidden:
            continue
        own = click.Context(command, info_name=name, parent=context)
        yield (*path, name), own
        if isinstance(command, click.Group):
            yield from _below(command, own, (*path, name))


def summary(context: click.Context) -> str:
    """Return the first sentence of what a command says of itself."""
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
    """Return the command with those before it, and their arguments."""
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
    """Return text for a table's cell, on one line and without a bar that would end it."""
    return " ".join(text.split()).replace("|", "\\|")
