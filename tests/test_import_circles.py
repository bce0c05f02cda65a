"""No module imports one that imports it, directly or by others: imports for types, and inside functions, count too."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import whirlmap

SOURCE = Path(whirlmap.__file__).parent


def imports_of(module, path, modules):
    """Modules of the package that one imports, wherever the statement stands."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("whirlmap"):
            for name in node.names:
                found = f"{node.module}.{name.name}"
                yield found if found in modules else node.module


def test_imports_have_no_circles():
    paths = {".".join(("whirlmap", *p.relative_to(SOURCE).with_suffix("").parts)): p for p in SOURCE.rglob("*.py")}
    modules = {name.removesuffix(".__init__"): path for name, path in paths.items()}
    assert len(modules) > 350
    public = {"whirlmap"}  # names its modules for those who use it, and is imported by none for its names
    graph = {m: {i for i in imports_of(m, p, modules) if i in modules} - {m} for m, p in modules.items() if m not in public}
    TopologicalSorter(graph).prepare()  # raises CycleError, which names the circle
