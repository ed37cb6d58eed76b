"""``python -m benchmarks.validity``; a module of its own, so that its processes find the rest."""

from benchmarks.validity.benchmark import main

if __name__ == "__main__":
    main()
