"""Running the commands of a page in a folder, and inserting their output into the page.

- ``sh``: run, all lines as one script. ``sh elsewhere`` needs a server or an account and is not
  run; ``sh fails`` is expected to be refused.
- ``text``, right after such a block: the first and last lines of its output. ``text 6+2`` keeps
  six and two.
- ``toml FILE``: settings that the reader should make in FILE; ``toml FILE -conditions.ours``
  removes the section ``conditions.ours`` first.
"""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any, Final, cast

import tomlkit
from tomlkit.items import Table

from motion.errors import InputError
from motion.files import write_text
from tools.handbook.fenced import Fenced, fenced_blocks, follows, with_body

_PROGRESS: Final = re.compile(r"[\w ]+: \d+ of \d+ \w+(, .*)?")
_ONE_TIME_LINK: Final = re.compile(r"(/research/(?:join|password)/|/try/\?invitation=)[\w-]+")
_KEPT: Final = re.compile(r"(\d+)\+(\d+)")
LEFT_OUT: Final = "…"

KEPT: Final = "14+3"
"""Lines shown of a longer output by default."""

ELSEWHERE: Final = "elsewhere"
_FAILS: Final = "fails"
_SERVES: Final = ("motionjury serve ", "motionjury desk ")
_IS_SERVED: Final = "/research/join/"


def steady(output: str, folder: Path) -> list[str]:
    """Return the lines without what differs from run to run.

    Progress and the path of `folder` are removed, and one-time links are shortened.
    """
    lines = []
    for line in output.splitlines():
        text = line.rstrip().replace(f"{folder}/", "")
        if not _PROGRESS.fullmatch(text):
            lines.append(_ONE_TIME_LINK.sub(rf"\g<1>{LEFT_OUT}", text))
    return lines


def shortened(lines: list[str], kept: str) -> list[str]:
    """Return the first and the last of many lines.

    Parameters
    ----------
    lines : list of str
        All lines.
    kept : str
        Numbers of first and last lines, such as ``6+2``.
    """
    match = _KEPT.fullmatch(kept)
    if match is None:
        raise ValueError(f"{kept!r} does not say how many lines to keep; write it as 6+2")
    first, last = map(int, match.groups())
    if len(lines) <= first + last + 1:
        return lines
    return [*lines[:first], LEFT_OUT, *lines[len(lines) - last :]]


def run_page(
    page: str,
    folder: Path,
    *,
    on_block: Callable[[str], None] | None = None,
    since: str = "",
    until: str = "",
) -> str:
    """Run the commands of a page in `folder` and return the page with their output.

    Parameters
    ----------
    page : str
        Markdown.
    folder : Path
        Folder in which they run.
    on_block : callable, optional
        Called with each script before it is run.
    since, until : str
        Words of the page at which to begin, and before which to stop; by default all of it runs.

    Raises
    ------
    InputError
        If a script fails unexpectedly, or succeeds when it should fail.
    """
    start = page.index(since) if since else 0
    end = page.index(until) if until else len(page)
    blocks = [block for block in fenced_blocks(page) if start <= block.start < end]
    printed: list[tuple[Fenced, str]] = []
    for at, block in enumerate(blocks):
        if block.language == "toml" and block.words:
            _edit(folder / block.words[0], block.body, without=block.words[1:])
        if block.language != "sh" or ELSEWHERE in block.words:
            continue
        if on_block is not None:
            on_block(block.body)
        lines = _run(block, folder)
        shown = blocks[at + 1] if at + 1 < len(blocks) else None
        if shown is not None and shown.language == "text" and follows(page, block, shown):
            kept = shortened(lines, shown.words[0] if shown.words else KEPT)
            printed.append((shown, "".join(f"{line}\n" for line in kept)))
    for shown, text in reversed(printed):
        page = with_body(page, shown, text)
    return page


def _run(block: Fenced, folder: Path) -> list[str]:
    script = block.body
    environment = {
        **os.environ,
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    }
    arguments = ["bash", "-e", "-o", "pipefail", "-c", script]
    if script.splitlines()[-1].startswith(_SERVES):
        return steady(_served(arguments, folder, environment), folder)
    done = subprocess.run(  # noqa: S603 — the pages are the project's own
        arguments,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if (done.returncode != 0) != (_FAILS in block.words):
        what = "failed" if done.returncode else "was expected to fail"
        raise InputError(f"{script.strip()!r} {what}: {done.stdout.strip()[-2000:]}")
    return steady(done.stdout, folder)


def _served(arguments: list[str], folder: Path, environment: dict[str, str]) -> str:
    """Return a server's output until it listens, and interrupt it."""
    server = subprocess.Popen(  # noqa: S603 — the pages are the project's own
        arguments,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    output_lines = []
    try:
        for line in cast("IO[str]", server.stdout):
            output_lines.append(line)
            if _IS_SERVED in line:
                break
        else:
            raise InputError(f"the server ended: {''.join(output_lines)}")
    finally:
        os.killpg(server.pid, signal.SIGINT)
        server.communicate(timeout=60)
    return "".join(output_lines)


def _edit(path: Path, words: str, *, without: Sequence[str]) -> None:
    """Replace sections of a TOML file, keeping the rest and its comments."""
    document = tomlkit.parse(path.read_text(encoding="utf-8"))
    for section in without:
        *above, last = section.removeprefix("-").split(".")
        table: Any = document
        for key in above:
            table = table[key]
        table.pop(last)
    _merge(document, tomlkit.parse(words))
    write_text(path, tomlkit.dumps(document))


def _merge(into: tomlkit.TOMLDocument | Table, new: tomlkit.TOMLDocument | Table) -> None:
    for key, value in new.items():
        old_value = into.get(key)
        if isinstance(value, Table) and isinstance(old_value, Table):
            _merge(old_value, value)
        else:
            into[key] = value
