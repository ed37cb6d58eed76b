"""The calls of ``motionjury`` on a page, and a check that the program accepts them."""

import shlex
from collections.abc import Iterator

import click

from studyapp.cli.main import group
from tools.handbook.fenced import fenced_blocks

_PROGRAM = "motionjury"
_SHELL = ("sh", "bash")
_ENDS = frozenset({"|", "||", "&&", ";", "&", ">", "<", "done", "(", ")"})


def calls(page: str) -> list[list[str]]:
    """Return the words after every ``motionjury`` in the page's shell blocks."""
    scripts = [block.body for block in fenced_blocks(page) if block.language in _SHELL]
    return [call for script in scripts for call in _calls_of(script)]


def _calls_of(script: str) -> Iterator[list[str]]:
    for line in script.replace("\\\n", " ").splitlines():
        reader = shlex.shlex(line, posix=True, punctuation_chars="|&;<>")
        reader.whitespace_split = True
        words = list(reader)
        for at, word in enumerate(words):
            begins = at == 0 or words[at - 1] in _ENDS or "=" in words[at - 1]
            rest = words[at + 1 :]
            # A command in a variable is unknown here.
            if "".join(rest[:1]).startswith("$"):
                continue
            if (word == _PROGRAM and begins) or word.endswith(f"/bin/{_PROGRAM}"):
                end = next((k for k, other in enumerate(rest) if other in _ENDS), len(rest))
                yield rest[:end]


def check_call(words: list[str]) -> None:
    """Parse a call as the program would, without checking that its files exist.

    Raises
    ------
    click.UsageError
        If the command, an option or a choice does not exist, or something is missing.
    """
    command: click.Command = group
    context = click.Context(group, info_name=_PROGRAM)
    rest = words
    while True:
        values, rest, _ = command.make_parser(context).parse_args(list(rest))
        for param in command.get_params(context):
            _check_value(param, values.get(param.name or ""), context)
        if not isinstance(command, click.Group):
            break
        if not rest:
            raise click.UsageError("a subcommand is missing", context)
        name, found, rest = command.resolve_command(context, list(rest))
        if found is None:
            raise click.UsageError(f"there is no {name}", context)
        command, context = found, click.Context(found, info_name=name, parent=context)
    if rest:
        raise click.UsageError(f"nobody takes {' '.join(rest)}", context)


def _check_value(param: click.Parameter, value: object, context: click.Context) -> None:
    nothing = value is None or not isinstance(value, str | bool | int | list | tuple)
    if param.required and (nothing or value in ((), [])):
        raise click.MissingParameter(ctx=context, param=param)
    if isinstance(param.type, click.Choice) and not nothing:
        given = value if isinstance(value, list | tuple) else [value]
        for each in given:
            # The value of a shell variable is unknown here.
            if "$" not in str(each):
                param.type.convert(each, param, context)
