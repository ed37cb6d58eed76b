"""``python -m benchmarks.validity``; separate because its processes import the rest."""

from benchmarks.validity.benchmark import main

if __name__ == "__main__":
    main()
