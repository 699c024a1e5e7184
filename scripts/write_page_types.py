"""`make page-types`: writes the page's types of the REST interface from its OpenAPI description.

``--check`` writes nothing and fails if the file is not what it would be. openapi-typescript is not used: it
needs the compiler interface of TypeScript 5, which later versions do not have, and carries no limits.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import Any

from galewood_server.app import create_app
from galewood_server.settings import Settings

TARGET_FILE = Path(__file__).resolve().parents[1] / "web/src/page/server/schema.ts"
LINE_WIDTH = 110
INDENT_TEXT = "  "
HEAD_COMMENT = (
    "/** Types and limits of the REST interface, from its OpenAPI description by `make page-types`. */"
)
LIMITED_SCHEMA = "TreeChanges"
"""The schema of the import options, whose limits the dialogs use."""
PLAIN_TYPES = {
    "string": "string",
    "number": "number",
    "integer": "number",
    "boolean": "boolean",
    "null": "null",
}
Schema = dict[str, Any]


def document() -> Schema:
    """The OpenAPI description of the service, whatever its settings are."""
    with tempfile.TemporaryDirectory() as folder:
        return create_app(Settings(data_dir=Path(folder))).openapi()


def generated(openapi: Schema) -> str:
    """The text of the module. ValueError for a schema that has no type in TypeScript here."""
    schemas: dict[str, Schema] = openapi["components"]["schemas"]
    lines = [HEAD_COMMENT, "", "export interface Schemas {"]
    for name, schema in schemas.items():
        lines += _member(name, schema, required=True, indent=INDENT_TEXT)
    limits = [
        f"{INDENT_TEXT}{name}: {{ min: {low:g}, max: {high:g} }},"
        for name, (low, high) in _limits(schemas[LIMITED_SCHEMA]).items()
    ]
    head = ["/** Smallest and largest values of the import options that are numbers. */"]
    lines += ["}", "", *head, "export const IMPORT_LIMITS = {", *limits, "} as const;"]
    return "\n".join(lines) + "\n"


def _member(name: str, schema: Schema, required: bool, indent: str) -> list[str]:
    key = name if re.fullmatch(r"[A-Za-z_]\w*", name) else json.dumps(name)
    mark = "" if required else "?"
    lines = _comment(schema.get("description", ""), indent)
    kind = _type(schema, indent)
    line = f"{indent}{key}{mark}: {kind};"
    if len(line.split("\n", 1)[0]) > LINE_WIDTH:
        parts = [f"{indent}{INDENT_TEXT}| {one}" for one in _alternatives(schema, indent)]
        line = f"{indent}{key}{mark}:\n" + "\n".join(parts) + ";"
    return [*lines, line]


def _comment(text: str, indent: str) -> list[str]:
    words = " ".join(text.split())
    if not words:
        return []
    if len(words) + len(indent) + len("/**  */") <= LINE_WIDTH:
        return [f"{indent}/** {words} */"]
    rows = textwrap.wrap(words, LINE_WIDTH - len(indent) - len(" * "), break_on_hyphens=False)
    return [f"{indent}/**", *(f"{indent} * {row}" for row in rows), f"{indent} */"]


def _type(schema: Schema, indent: str) -> str:
    return " | ".join(_alternatives(schema, indent))


def _alternatives(schema: Schema, indent: str) -> list[str]:
    """The types of which a value has one, without repetitions."""
    match schema:
        case {"$ref": str(reference)}:
            return [f'Schemas["{reference.rpartition("/")[2]}"]']
        case {"anyOf": list(options)}:
            return list(dict.fromkeys(one for option in options for one in _alternatives(option, indent)))
        case {"enum": list(values)}:
            return [json.dumps(value) for value in values]
        case {"const": value}:
            return [json.dumps(value)]
        case {"type": "array", "prefixItems": list(items)}:
            return [f"[{', '.join(_type(one, indent) for one in items)}]"]
        case {"type": "array", "items": dict(items)}:
            inner = _alternatives(items, indent)
            return [f"({' | '.join(inner)})[]" if len(inner) > 1 else f"{inner[0]}[]"]
        case {"type": "object", "properties": dict(properties)}:
            needed = schema.get("required", [])
            rows = [
                row
                for name, one in properties.items()
                for row in _member(name, one, name in needed, indent + INDENT_TEXT)
            ]
            return ["{\n" + "\n".join(rows) + f"\n{indent}}}"]
        case {"type": "object"}:
            values = schema.get("additionalProperties")
            return [f"Record<string, {_type(values, indent) if isinstance(values, dict) else 'unknown'}>"]
        case {"type": str(kind)} if kind in PLAIN_TYPES:
            return [PLAIN_TYPES[kind]]
        case _ if not schema.keys() - {"title", "description", "default"}:
            return ["unknown"]
        case _:
            raise ValueError(f"no type for {schema}")


def _limits(schema: Schema) -> dict[str, tuple[float, float]]:
    """The inclusive limits of the numbers that have both."""
    found: dict[str, tuple[float, float]] = {}
    for name, field in schema["properties"].items():
        for one in field.get("anyOf", [field]):
            if {"minimum", "maximum"} <= one.keys():
                found[name] = (one["minimum"], one["maximum"])
    return found


def main() -> None:
    """Write or check the file."""
    text = generated(document())
    if "--check" not in sys.argv:
        TARGET_FILE.write_text(text, encoding="utf-8")
    elif TARGET_FILE.read_text(encoding="utf-8") != text:
        sys.exit(f"{TARGET_FILE} is not what the service describes: run `make page-types`")


if __name__ == "__main__":
    main()
