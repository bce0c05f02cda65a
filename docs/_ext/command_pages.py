"""The commands, as a page of Markdown: usage, what each does, arguments, options by their groups, examples."""

import re
from typing import Any

from markdown_tables import code, table
from whirlmap.cli.main import COMMANDS, loaded

#: Group of the options that stand in none.
OTHERS = "Other options"

#: An option in a sentence, which is code there; in backticks it is already.
OPTION = re.compile(r"`[^`]*`|(?<![\w-])(--[a-z][a-z-]*)")


def commands() -> str:
    """All commands in the order of the program's own help."""
    return "\n\n".join(_command(name) for name in COMMANDS)


def _command(name: str) -> str:
    command = loaded(name)
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option"]
    usage = " ".join(["whirlmap", name, *(_argument(p) for p in arguments), *(["[OPTIONS]"] if options else [])])
    parts = [f"({name})=\n## whirlmap {name}", f"```text\n{usage}\n```", _text(command.help.strip())]
    if arguments:
        parts.append(table(("argument", "meaning"), [(code(p.metavar), _text(p.help)) for p in arguments]))
    groups: dict[str, list[Any]] = {}
    for p in options:
        groups.setdefault(p.rich_help_panel or OTHERS, []).append(p)
    for title, members in groups.items():
        rows = [(_option(p), _default(p), _text(p.help)) for p in members]
        parts.append(f"**{title}**\n\n" + table(("option", "default", "meaning"), rows))
    examples = [line.strip("- `") for line in (command.epilog or "").splitlines() if line.startswith("- ")]
    parts.append("**Examples**\n\n```sh\n" + "\n".join(examples) + "\n```")
    return "\n\n".join(parts) + "\n"


def _argument(p: Any) -> str:
    return p.metavar if p.required else f"[{p.metavar}]"


def _option(p: Any) -> str:
    spelt = " ".join(code(f"{opt} {p.metavar}" if p.metavar else opt) for opt in p.opts)
    return f"{spelt} (required)" if p.required else spelt


def _default(p: Any) -> str:
    plain = p.default is None or p.default is False or p.required or callable(p.default)
    return "" if plain else code(p.default)


def _text(help_text: str) -> str:
    return OPTION.sub(lambda found: code(found[1]) if found[1] else found[0], help_text)
