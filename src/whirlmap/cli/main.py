"""``whirlmap``: the program, its commands, and the handling of all errors.

Exit codes: 0 done, 1 a check failed, 2 the input was wrong, 130 interrupted.
"""

import sys
import warnings
from collections.abc import Sequence
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from whirlmap import __version__
from whirlmap.cli.commands import (
    attractors,
    basins,
    bench,
    bifurcation,
    cache,
    campbell,
    cases,
    diagnose,
    identify,
    improve,
    linear,
    map,  # noqa: A004
    new,
    reproduce,
    show,
    simulate,
    speeds,
)
from whirlmap.cli.common import interrupts
from whirlmap.cli.common.former_options import with_new_spellings
from whirlmap.cli.common.messages import UsageError, complain, given_twice, plain_letters, plain_words, say
from whirlmap.errors import WhirlmapError
from whirlmap.results.files import WRITTEN


class Program(TyperGroup):
    """The group of commands; turns errors of the user into one message and an exit code."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run a command, and exit with its code."""
        program = prog_name or "whirlmap"
        try:
            code = super().main(args, program, complete_var, False, windows_expand_args, **extra)
            if not standalone_mode:
                return code
        except WhirlmapError as error:
            if not standalone_mode:
                raise
            complain(str(error))
            code = 2
        except UsageError as error:
            if not standalone_mode:
                raise
            complain(plain_words(error))
            code = 2
        sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: Any) -> Any:
        """Invoke the command; Ctrl-C that it did not answer itself ends it."""
        WRITTEN.clear()
        interrupts.keep()
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            files = " ".join(str(file) for file in WRITTEN)
            nothing = "interrupted: nothing was finished, so nothing was written"
            say(f"interrupted after writing {files}" if files else nothing)
            raise typer.Exit(interrupts.INTERRUPTED) from None


class Command(TyperCommand):
    """A command that refuses an option given twice with different values."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments."""
        args = with_new_spellings(self.name or "", args)
        given_twice(self.params, args)
        return super().parse_args(ctx, args)


app = typer.Typer(
    cls=Program,
    add_completion=False,
    invoke_without_command=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
)

EXAMPLES = (
    "whirlmap cases",
    "whirlmap show gear-psfd/machine",
    "whirlmap diagnose duffing --set gamma=0.29",
    "whirlmap bifurcation gear-psfd/intended --vary s=0.3:4:600 --out diagram.png",
    "whirlmap reproduce",
)


def epilog(examples: Sequence[str]) -> str:
    """Examples as they stand at the end of a help text."""
    return "\n\n".join(["**Examples**", *(f"- `{line}`" for line in examples)])


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"whirlmap {__version__}")
        raise typer.Exit


@app.callback(epilog=epilog(EXAMPLES))
def program(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001 (read by its callback)
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Say where a geared rotor runs periodically, and where it turns quasi-periodic or chaotic.

    Each command takes a case, a named set of parameters, and changes to it, and prints what it found; with
    --out it also writes files. Every command explains itself with --help.
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


for module in (
    cases, show, new, simulate, diagnose, linear, campbell, bifurcation, map, speeds, improve, attractors, basins, reproduce,
    identify, cache, bench,
):  # fmt: skip
    name = module.__name__.rpartition(".")[2]
    app.command(name, cls=Command, epilog=epilog(module.EXAMPLES))(getattr(module, name))


def run() -> None:
    """Entry point of the program."""
    interrupts.begin()
    plain_letters()
    warnings.showwarning = lambda message, *_, **__: say(f"warning: {message}")
    app(prog_name="whirlmap")
