"""``whirlmap``: the program, its commands, and the handling of all errors.

Exit codes: 0 done, 1 a check failed, 2 the input was wrong, 130 interrupted.
"""

import sys
import warnings
from collections.abc import Sequence
from functools import cache, wraps
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from whirlmap import __version__
from whirlmap.cli.common import interrupts
from whirlmap.cli.common.checkout import has_comparison
from whirlmap.cli.common.former_options import with_new_spellings
from whirlmap.cli.common.messages import UsageError, complain, given_twice, plain_letters, plain_words, say, taking_values
from whirlmap.errors import WhirlmapError
from whirlmap.results.files import WRITTEN

#: The commands, with what the program's own help says of each. Options and help are in `whirlmap.cli.declared`, which is
#: quickly read; what it does is in `whirlmap.cli.commands`, imported when it runs, with all that it computes by.
COMMANDS = {
    "cases": "List the stock cases: named sets of parameters, each number with its source.",
    "show": "Print every symbol of CASE with its value, unit, meaning and source.",
    "new": "Write a template of a machine: every input with its unit and meaning, filled with the numbers of another one.",
    "simulate": "Integrate one operating point of CASE and report the range of each state and output.",
    "diagnose": "Diagnose the regime of one operating point of CASE, with the evidence.",
    "linear": "Linearise CASE about its static equilibrium, with all forcing off.",
    "campbell": "Compute the damped frequencies of CASE against a parameter, and the critical speeds at which order"
    " lines cross them.",
    "bifurcation": "Sweep one parameter of CASE and label the regime of every point.",
    "continue": "Follow branches of periodic orbits of CASE against one parameter, stable or not, and locate their"
    " bifurcations.",
    "map": "Label the regime of every point of a grid over parameters of CASE.",
    "speeds": "Find the windows of speed in which CASE runs periodically and within a limit of vibration.",
    "improve": "Compare values of one or two design parameters of CASE by the safe speeds that they give.",
    "attractors": "Find the attractors that coexist at one operating point of CASE, and the share of the starts that"
    " lead to each.",
    "basins": "Colour a two-dimensional slice of start states of CASE by the attractor that each leads to.",
    "explore": "Explore a map or a diagram in the browser, with the motion of the point that one clicks.",
    "reproduce": "Draw Figures 2 to 7 of the paper and judge each of its claims.",
    "identify": "Judge the paper's claims for every plausible set of its unpublished parameters.",
    "cache": "Show the folder of compiled kernels, its size and what kernels are compiled for, or clear it.",
    "bench": "Compare the speed of whirlmap with heyoka, SciPy and plain C on the gear pair, on one core, at equal error.",
}


#: Modules of the commands whose name is a word of Python.
MODULES = {"continue": "continue_orbit"}


class Program(TyperGroup):
    """The group of commands; turns errors of the user into one message and an exit code."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Find the command that is called, and import it."""
        name, found, rest = super().resolve_command(ctx, args)
        return name, loaded(name) if name else found, rest

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
        args = with_new_spellings(self.name or "", args, taking_values(self.params))
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


def _listed() -> None:
    """Stand for a command in the list of them, until it is called."""


for name, line in COMMANDS.items():
    app.command(name, short_help=line, hidden=name == "bench" and not has_comparison())(_listed)


@cache
def loaded(name: str) -> Any:
    """Import the options and the help of a command; what it computes by is imported when it runs."""
    home = MODULES.get(name, name)
    module = import_module(f"whirlmap.cli.declared.{home}")
    declared = getattr(module, home)

    @wraps(declared)
    def command(**given: Any) -> None:
        whole = getattr(declared, "whole", dict)(**given)  # see `options.computing`
        getattr(import_module(f"whirlmap.cli.commands.{home}"), home)(**whole)

    alone = typer.Typer(add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False)
    alone.command(name, cls=Command, epilog=epilog(module.EXAMPLES))(command)
    return typer.main.get_command(alone)


def run() -> None:
    """Entry point of the program."""
    interrupts.begin()
    plain_letters()
    warnings.showwarning = lambda message, *_, **__: say(f"warning: {message}")
    app(prog_name="whirlmap")
