"""``cube-sim``, which is ``python -m cube_sim`` too."""

from cube_sim.commands.leaving import leave_on_interrupt


def main() -> None:
    """Run the command line, which Ctrl-C ends quietly while it loads as well."""
    leave_on_interrupt()
    from cube_sim.commands.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
