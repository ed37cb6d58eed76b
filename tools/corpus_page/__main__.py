"""``python -m tools.corpus_page FOLDER [--write FILE]``: measure a corpus.

Prints the tables of docs/corpus.md, or puts them between the marks in FILE.
"""

import argparse
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from tools.corpus_page.measuring import (
    BEAT,
    MeasuredTake,
    classifier_scores,
    decided,
    minutes,
    paces,
    read_measured,
)
from tools.markdown import write_part

_STILL = "it does not change"
_ALONE = "nobody speaks two texts of an emotion"


def main() -> None:
    """Measure the corpus named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="a corpus made by 'motionjury corpus'")
    parser.add_argument(
        "--write", type=Path, metavar="FILE", help="a page with marks for the tables"
    )
    args = parser.parse_args()
    takes = read_measured(args.folder)
    size = sum(path.stat().st_size for path in args.folder.rglob("*") if path.is_file())
    text = "\n".join(tables(takes, size))
    if args.write is None:
        print(text)
        return
    write_part(args.write, "measured", text)


def tables(takes: Sequence[MeasuredTake], size: int) -> Iterator[str]:
    """Yield the lines of the measurements, as Markdown; `size` is in bytes."""
    lengths = minutes(takes)
    parts = ", ".join(f"{length:.1f} for {split}" for split, length in lengths.items())
    yield f"{len(takes)} takes, {sum(lengths.values()):.1f} minutes ({parts}), {size / 1e6:.0f} MB."
    yield ""
    yield "| curve | variance explained | correlation within takes | with other speech | takes |"
    yield "|---|---|---|---|---|"
    for curve in decided(takes):
        yield (
            f"| {curve.curve.replace('_', ' ')} | {_number(curve.explained, _STILL)} "
            f"| {_number(curve.correlation, _STILL)} | {_number(curve.of_other_speech, _ALONE)} "
            f"| {curve.takes} |"
        )
    yield ""
    yield "| identified by the nearest class mean | correct | chance | test takes |"
    yield "|---|---|---|---|"
    for line in classifier_scores(takes):
        right = f"{line.share:.0%}" if line.takes else "– (there is no such take)"
        yield f"| {line.what} | {right} | {line.chance:.0%} | {line.takes} |"
    yield ""
    yield "| wrists | mean | median | 95th percentile |"
    yield "|---|---|---|---|"
    for source, speeds in (("here", paces(take.wrists for take in takes)), ("BEAT", BEAT)):
        for pace in speeds:
            values = f"{pace.mean:.2f} | {pace.median:.2f} | {pace.high:.2f}"
            yield f"| {pace.quantity}, {source} | {values} |"


def _number(value: float, why_not: str) -> str:
    return f"– ({why_not})" if math.isnan(value) else f"{value:.2f}"


if __name__ == "__main__":
    main()
