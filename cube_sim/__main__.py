"""``python -m cube_sim`` is ``cube-sim``."""

from cube_sim.commands.cli import main

if __name__ == "__main__":
    main()
