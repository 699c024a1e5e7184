"""How deep a COLLADA document is nested: its elements, its nodes with all their instances, its parameters."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

from galewood.formats.graph_depth import MAX_DEPTH, problem_of

NODES = ("node", "visual_scene")
REFERENCES = ("source", "init_from", "instance_image")
TOO_DEEP = f"are nested deeper than {MAX_DEPTH} levels"


def problem_of_collada(data: bytes) -> str | None:
    """The end of a sentence that says why the file is not read; None if it can be.

    Raises ValueError if the document is no XML.
    """
    reader = _Reader()
    parser = expat.ParserCreate()
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.text
    try:
        parser.Parse(data, True)
    except _TooDeepError:
        return TOO_DEEP
    except (expat.ExpatError, LookupError) as error:
        raise ValueError(str(error)) from error
    if any(_is_circular(parameters) for parameters in reader.parameters):
        return "have materials whose parameters form a cycle"
    return problem_of(reader.below())


class _TooDeepError(Exception):
    """Ends the parsing."""


@dataclass
class _Node:
    """A node of the document, with the numbers of its children and the names of its instances."""

    children: list[int] = field(default_factory=list[int])
    instances: list[str] = field(default_factory=list[str])


class _Reader:
    """Collects nodes and references while a document is parsed."""

    def __init__(self) -> None:
        self.parameters: list[dict[str, str]] = [{}]  # of each effect: what each refers to
        self._nodes: list[_Node] = []
        self._library: dict[str, list[int]] = {}
        self._named: dict[str, list[int]] = {}  # by id or name
        self._depth = 0
        self._open: list[int] = []
        self._parameter = ""
        self._refers = False

    def start(self, tag: str, given: dict[str, str]) -> None:
        """An element begins."""
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise _TooDeepError
        tag = tag.rpartition(":")[2]
        url = given.get("url", "").removeprefix("#")
        if tag in NODES:
            self._open_node(given)
        elif tag == "instance_node" and self._open:
            self._nodes[self._open[-1]].instances.append(url)
        elif tag == "effect":
            self.parameters.append({})
        elif tag == "newparam":
            self._parameter = given.get("sid", "")
        self._refers = tag in REFERENCES and bool(self._parameter)
        if self._refers:
            self.parameters[-1][self._parameter] = url

    def end(self, tag: str) -> None:
        """An element ends."""
        self._depth -= 1
        self._refers = False
        tag = tag.rpartition(":")[2]
        if tag in NODES:
            self._open.pop()
        elif tag == "newparam":
            self._parameter = ""

    def text(self, content: str) -> None:
        """Text between elements, in pieces."""
        if self._refers:
            self.parameters[-1][self._parameter] += content

    def below(self) -> list[list[int]]:
        """What each node contains; instances are looked for in the library, then everywhere."""
        return [
            [
                *node.children,
                *(k for name in node.instances for k in self._library.get(name) or self._named.get(name, [])),
            ]
            for node in self._nodes
        ]

    def _open_node(self, given: dict[str, str]) -> None:
        number = len(self._nodes)
        self._nodes.append(_Node())
        if self._open:
            self._nodes[self._open[-1]].children.append(number)
        elif "id" in given:
            self._library.setdefault(given["id"], []).append(number)
        self._open.append(number)
        for name in {given[key] for key in ("id", "name") if key in given}:
            self._named.setdefault(name, []).append(number)


def _is_circular(parameters: dict[str, str]) -> bool:
    """Whether a parameter refers to itself through others."""
    refers_to = {name: target.strip() for name, target in parameters.items()}
    known: set[str] = set()  # to lead to an end
    for first in refers_to:
        way: dict[str, None] = {}
        name = first
        while name in refers_to and name not in known and name not in way:
            way[name] = None
            name = refers_to[name]
        if name in way:
            return True
        known.update(way)
    return False
