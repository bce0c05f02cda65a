"""From a WebAssembly object file, as LLVM writes it, to a module that a browser loads.

A linker would place several object files and their data together. A kernel is one file without data, whose functions call
each other by indices that are already right, so that only the list of what it exports is missing: that is inserted here.

References: WebAssembly Core Specification 2.0, section 5.5 (sections and their numbers); WebAssembly tool conventions,
Linking (the custom section ``linking`` with the names of functions).
"""

from collections.abc import Iterator, Sequence

#: Bytes that a module begins with: its mark and version.
HEAD = b"\0asm\x01\0\0\0"
#: Numbers of sections.
CUSTOM, IMPORT, EXPORT, ELEMENTS, DATA = 0, 2, 7, 9, 11
#: Kinds of imports, by number: what follows each is read differently.
FUNCTION, TABLE, MEMORY, GLOBAL = range(4)
#: The table of symbols in the section ``linking``; flags of a symbol that is not defined here, and of one with a name of its
#: own all the same.
SYMBOLS, UNDEFINED, NAMED = 8, 0x10, 0x40


class Reader:
    """Reads numbers and names of a binary module from a place on."""

    def __init__(self, data: bytes, at: int = 0) -> None:
        self.data, self.at = data, at

    def byte(self) -> int:
        """One byte."""
        self.at += 1
        return self.data[self.at - 1]

    def number(self) -> int:
        """A whole number in groups of seven bits (LEB128)."""
        out = shift = 0
        while True:
            byte = self.byte()
            out |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return out

    def take(self, count: int) -> bytes:
        """So many bytes."""
        self.at += count
        return self.data[self.at - count : self.at]

    def name(self) -> str:
        """A name, after its length."""
        return self.take(self.number()).decode()

    def limits(self) -> None:
        """Pass over the size of a memory or table."""
        if self.byte() & 1:
            self.number()
        self.number()


def leb(number: int) -> bytes:
    """A whole number in groups of seven bits, as `Reader.number` reads it."""
    out = bytearray()
    while True:
        number, low = number >> 7, number & 127
        out.append(low | (128 if number else 0))
        if not number:
            return bytes(out)


def sections(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and content of every section."""
    if not data.startswith(HEAD):
        raise RuntimeError("the compiler wrote no WebAssembly object file")
    reader = Reader(data, len(HEAD))
    while reader.at < len(data):
        number = reader.byte()
        yield number, reader.take(reader.number())


def imported(data: bytes) -> list[str]:
    """Names of all that a module needs from without, memory and stack among it."""
    names = []
    for number, content in sections(data):
        reader = Reader(content)
        for _ in range(reader.number() if number == IMPORT else 0):
            reader.name()
            names.append(reader.name())
            kind = reader.byte()
            if kind == FUNCTION:
                reader.number()
            elif kind == GLOBAL:
                reader.take(2)
            else:
                if kind == TABLE:
                    reader.byte()
                reader.limits()
    return names


def loadable(data: bytes, exports: Sequence[str]) -> bytes:
    """Return the module of an object file, which exports some of its functions.

    Raises
    ------
    RuntimeError
        The file holds data or tables of functions, which only a linker can place; or it has no such function.
    """
    parts = list(sections(data))
    if {number for number, _ in parts} & {ELEMENTS, DATA}:
        raise RuntimeError("the kernel holds data of its own, which it cannot do without a linker")
    known = _functions(parts)
    if missing := set(exports) - known.keys():
        raise RuntimeError(f"the kernel has no function {' or '.join(sorted(missing))}")
    entries = [leb(len(name)) + name.encode() + bytes([FUNCTION]) + leb(known[name]) for name in exports]
    made = [(number, content) for number, content in parts if number not in (CUSTOM, EXPORT)]
    at = sum(number < EXPORT for number, _ in made)
    made.insert(at, (EXPORT, leb(len(entries)) + b"".join(entries)))
    return HEAD + b"".join(bytes([number]) + leb(len(content)) + content for number, content in made)


def _functions(parts: list[tuple[int, bytes]]) -> dict[str, int]:
    """Index of every function that is defined here, by name."""
    out: dict[str, int] = {}
    for number, content in parts:
        reader = Reader(content)
        if number != CUSTOM or reader.name() != "linking":
            continue
        reader.number()  # version
        while reader.at < len(content):
            kind, end = reader.byte(), reader.number()
            end += reader.at
            if kind == SYMBOLS:
                out |= dict(_symbols(reader))
            reader.at = end
    return out


def _symbols(reader: Reader) -> Iterator[tuple[str, int]]:
    for _ in range(reader.number()):
        kind, flags = reader.byte(), reader.number()
        if kind == 1:  # data
            reader.name()
            for _ in range(0 if flags & UNDEFINED else 3):
                reader.number()
        elif kind == 3:  # a section
            reader.number()
        else:  # a function, global, event or table
            index = reader.number()
            if not flags & UNDEFINED or flags & NAMED:
                name = reader.name()
                if kind == 0 and not flags & UNDEFINED:
                    yield name, index
