"""``python -m cube_sim`` is ``cube-sim``."""

from .cli import main

if __name__ == "__main__":
    main()
