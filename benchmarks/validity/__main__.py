"""``python -m benchmarks.validity``; separate, so that its processes can import the rest."""

from benchmarks.validity.benchmark import main

if __name__ == "__main__":
    main()
