"""``python -m analysis.validity``."""

from analysis.validity.benchmark import main

if __name__ == "__main__":
    main()
