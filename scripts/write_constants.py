"""`make constants`: writes the modules of the constants that Python and TypeScript share.

spec/constants.json says each once: its value, its unit if it has one, and what it means.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

ROOT = Path(__file__).resolve().parents[1]
SOURCE_FILE = "spec/constants.json"
LINE_WIDTH = 110
ABOUT_TEXT = f"Constants that Python and TypeScript share, written from {SOURCE_FILE} by `make constants`."
NAME_PATTERN = re.compile(r"[A-Z0-9]+(_[A-Z0-9]+)+")
"""Names of one word say too little outside of the module that they were made for."""

Entry = Mapping[str, Any]
"""``page``: of TypeScript for the page only; ``kernel``: for the kernel as well, as f32."""
Groups = Mapping[str, Mapping[str, Entry]]
Value = int | float | str | bool | list[Any] | dict[str, Any]


@dataclass(frozen=True)
class Language:
    """How a language writes collections and comments."""

    comment: str
    indent: int
    brackets: tuple[str, str]
    """Around a list."""
    brace: str
    """Between a brace and what it encloses on the same line."""
    whole_numbers: bool
    """Whether 1 and 1.0 are the same."""


PYTHON_SYNTAX = Language("#", 4, ("(", ")"), "", whole_numbers=False)
TYPESCRIPT_SYNTAX = Language("//", 2, ("[", "]"), " ", whole_numbers=True)


def read_groups(root: Path) -> Groups:
    """The constants by group and name. Raises ValueError for a name of one word or one that comes twice."""
    groups = cast(Groups, json.loads((root / SOURCE_FILE).read_text(encoding="utf-8")))
    names = [name for group in groups.values() for name in group]
    wrong = {name for name in names if names.count(name) > 1 or not NAME_PATTERN.fullmatch(name)}
    if wrong:
        raise ValueError(f"{SOURCE_FILE}: twice, or of one word: {', '.join(sorted(wrong))}")
    return groups


def generated(root: Path) -> dict[str, str]:
    """The text of every generated file by its path."""
    groups = read_groups(root)
    return {
        "precompute/galewood/constants.py": _python_module(groups),
        "web/player/src/core/constants.ts": _typescript_module(groups, lambda entry: "page" not in entry),
        "web/src/constants.ts": _typescript_module(groups, lambda entry: "page" in entry),
        "web/kernel/constants.ts": _typescript_module(groups, lambda entry: "kernel" in entry, "f32"),
    }


def _python_module(groups: Groups) -> str:
    head = f'"""{ABOUT_TEXT}"""\n\nfrom __future__ import annotations\n\n'
    head += "from collections.abc import Mapping\nfrom typing import Any\n"
    return head + "".join(
        _title(title, PYTHON_SYNTAX) + "".join(_python_constant(name, entry) for name, entry in group.items())
        for title, group in groups.items()
    )


def _typescript_module(groups: Groups, wanted: Callable[[Entry], bool], kind: str = "") -> str:
    text = _comment(ABOUT_TEXT)
    for title, group in groups.items():
        chosen = [_typescript_constant(name, entry, kind) for name, entry in group.items() if wanted(entry)]
        text += _title(title, TYPESCRIPT_SYNTAX) + "".join(chosen) if chosen else ""
    return text


def _title(title: str, language: Language) -> str:
    return "\n" + f"{language.comment} ---- {title} ".ljust(LINE_WIDTH, "-") + "\n\n"


def _python_constant(name: str, entry: Entry) -> str:
    declared = f"{name}: Mapping[str, Any] = " if isinstance(entry["value"], dict) else f"{name} = "
    said = _said(entry)
    if len(said) + 6 > LINE_WIDTH:
        said = textwrap.fill(said, LINE_WIDTH - 3) + "\n"
    return f'{declared}{laid_out(entry["value"], PYTHON_SYNTAX, len(declared))}\n"""{said}"""\n'


def _typescript_constant(name: str, entry: Entry, kind: str) -> str:
    declared = f"export const {name}{f': {kind}' if kind else ''} = "
    end = " as const;" if isinstance(entry["value"], list | dict) else ";"
    value = laid_out(entry["value"], TYPESCRIPT_SYNTAX, len(declared + end))
    return f"{_comment(_said(entry))}{declared}{value}{end}\n"


def _said(entry: Entry) -> str:
    """The meaning, with the unit in front of its full stop."""
    unit = f" [{entry['unit']}]." if "unit" in entry else "."
    return entry["meaning"].removesuffix(".") + unit


def _comment(said: str) -> str:
    if len(said) + 7 <= LINE_WIDTH:
        return f"/** {said} */\n"
    return "/**\n" + textwrap.indent(textwrap.fill(said, LINE_WIDTH - 3), " * ") + "\n */\n"


def laid_out(value: Value, language: Language, used: int, indent: int = 0) -> str:
    """A value on one line if it fits behind the ``used`` characters of it, otherwise an element in each."""
    if not isinstance(value, list | dict):
        return _on_one_line(value, language)
    if used + len(_on_one_line(value, language)) <= LINE_WIDTH and not _of_collections(value):
        return _on_one_line(value, language)
    inner = indent + language.indent
    lines = [
        f"{' ' * inner}{key}{laid_out(part, language, inner + len(key) + 1, inner)},\n"
        for key, part in _parts(value, language)
    ]
    first, last = "{}" if isinstance(value, dict) else language.brackets
    return f"{first}\n{''.join(lines)}{' ' * indent}{last}"


def _of_collections(value: list[Any] | dict[str, Any]) -> bool:
    parts = value.values() if isinstance(value, dict) else value
    return len(value) > 1 and all(isinstance(part, list | dict) for part in parts)


def _on_one_line(value: Value, language: Language) -> str:
    if isinstance(value, float):
        return _number(value, language)
    if not isinstance(value, list | dict):
        return (
            str(value)
            if value is True and language is PYTHON_SYNTAX
            else json.dumps(value, ensure_ascii=False)
        )
    parts = ", ".join(key + _on_one_line(part, language) for key, part in _parts(value, language))
    if isinstance(value, dict):
        return f"{{{language.brace}{parts}{language.brace}}}"
    first, last = language.brackets
    return first + parts + ("," if len(value) == 1 and language is PYTHON_SYNTAX else "") + last


def _parts(value: list[Any] | dict[str, Any], language: Language) -> list[tuple[str, Any]]:
    """The elements of a collection, each with the text before it."""
    if isinstance(value, list):
        return [("", part) for part in value]
    quoted = {
        key: key if language is TYPESCRIPT_SYNTAX and key.isidentifier() else f'"{key}"' for key in value
    }
    return [(f"{quoted[key]}: ", part) for key, part in value.items()]


def _number(value: float, language: Language) -> str:
    """The shortest text that gives the same double again."""
    short = f"{value:.0e}" if abs(value) >= 1e6 and float(f"{value:.0e}") == value else repr(value)
    digits, e, exponent = short.partition("e")
    if e:
        return f"{digits}e{int(exponent)}"
    return digits.removesuffix(".0") if language.whole_numbers else digits


def write(root: Path) -> None:
    """Write every generated file."""
    for path, text in generated(root).items():
        (root / path).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write(ROOT)
