"""Speed of the statistics compared with others: ``python -m benchmarks.statistics``.

Prints ``name: value`` lines. Both sides of every ratio run in turn in the same run; times are
processor times, on which other work on the machine has little effect. Comparisons with software
that is not installed are skipped, with the reason.
"""

import argparse
from collections.abc import Sequence
from functools import partial

from benchmarks.statistics.beside_python import (
    beside_choix,
    beside_gather,
    made_votes,
    timed,
    why_not_choix,
)
from benchmarks.statistics.beside_r import beside_r, fitted, made_answers, why_not_r


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Compare the statistics with R and choix.")
    parser.add_argument("--side", type=int, default=100, help="participants, and items, of clmm")
    parser.add_argument("--large-side", type=int, default=1000, help="the same, without R")
    parser.add_argument("--votes", type=int, default=1_000_000)
    parser.add_argument("--resamples", type=int, default=10_000)
    args = parser.parse_args(arguments)
    _ordinal(args.side, args.large_side)
    _bootstrap(args.resamples)
    _strengths(args.votes)


def _ordinal(side: int, large: int) -> None:
    missing = why_not_r()
    if missing:
        print(f"clmm_beside_r: skipped, {missing}")
    else:
        comparison = beside_r(made_answers(side, side))
        print(f"clmm_answers: {side * side}")
        print(f"clmm_s: {comparison.seconds:.3f}")
        print(f"clmm_r_s: {comparison.seconds_r:.3f}")
        print(f"clmm_times_faster: {comparison.times_faster:.1f}")
        print(f"clmm_estimates_apart: {comparison.estimates_apart:.1e}")
        print(f"clmm_effect_error_apart: {comparison.effect_error_apart:.1e}")
        print(f"clmm_log_likelihood_apart: {comparison.log_likelihood_apart:.1e}")
        print(f"clmm_agrees: {'yes' if comparison.agrees else 'no'}")
    answers = made_answers(large, large)
    whole, seconds = timed(partial(fitted, answers))
    _, reduced = timed(partial(fitted, answers, effect=False))
    print(f"clmm_large_answers: {large * large}")
    print(f"clmm_large_s: {seconds:.2f}")
    print(f"clmm_large_without_effect_s: {reduced:.2f}")
    print(f"clmm_large_converged: {'yes' if whole.converged else 'no'}", flush=True)


def _bootstrap(resamples: int) -> None:
    for participants, items in ((1000, 100), (316, 316)):
        comparison = beside_gather(participants, items, resamples=resamples)
        prefix = f"bootstrap_{participants}x{items}"
        print(f"{prefix}_s: {comparison.seconds:.3f}")
        print(f"{prefix}_gather_s: {comparison.seconds_gather:.3f}")
        print(f"{prefix}_times_faster: {comparison.times_faster:.1f}")
        print(f"{prefix}_deviations_apart: {comparison.deviations_apart:.1e}", flush=True)


def _strengths(count: int) -> None:
    missing = why_not_choix()
    if missing:
        print(f"bradley_terry_beside_choix: skipped, {missing}")
        return
    comparison = beside_choix(made_votes(count))
    print(f"bradley_terry_votes: {count}")
    print(f"bradley_terry_ms: {1000 * comparison.seconds:.1f}")
    print(f"bradley_terry_choix_ms: {1000 * comparison.seconds_choix:.1f}")
    print(f"bradley_terry_times_faster: {comparison.times_faster:.1f}")
    print(f"bradley_terry_strengths_apart: {comparison.strengths_apart:.1e}", flush=True)


if __name__ == "__main__":
    main()
