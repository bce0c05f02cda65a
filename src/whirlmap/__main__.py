"""``python -m whirlmap``, and what the program ``whirlmap`` begins with."""

from whirlmap.cli.common import interrupts


def run() -> None:
    """Run the program; Ctrl-C ends it without a traceback from the first moment on."""
    interrupts.begin()
    from whirlmap.cli.main import run as program

    program()


if __name__ == "__main__":
    run()
