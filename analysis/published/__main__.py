"""``python -m analysis.published FILE``: write the worked examples of the docs."""

from __future__ import annotations

import argparse
from pathlib import Path

from analysis.published.worked_examples import write_worked_examples


def main() -> None:
    """Write the file that is named on the command line."""
    parser = argparse.ArgumentParser(prog="python -m analysis.published", description=__doc__)
    parser.add_argument("file", type=Path, help="such as docs/worked-examples.md")
    write_worked_examples(parser.parse_args().file)


if __name__ == "__main__":
    main()
