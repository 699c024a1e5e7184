"""Command-line options that follow from the fields of a request model (galewood.options)."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer
from pydantic import BaseModel, ValidationError
from rich.markup import escape

from galewood.io.cli.tools import print_error
from galewood.options import list_fields

if TYPE_CHECKING:
    from galewood.wood import WoodDocument

Mesh = Annotated[
    Path,
    typer.Argument(
        exists=True,
        dir_okay=False,
        help="GLB, glTF, OBJ, PLY, STL, FBX, DAE, 3DS or ZIP; or a scanned tree's cylinders (MAT, CSV).",
    ),
]
WoodFile = Annotated[
    Path | None,
    typer.Option(
        "--wood-properties",
        exists=True,
        dir_okay=False,
        help="Custom wood properties, JSON (docs/how-to/own-wood.md).",
    ),
]
Request = TypeVar("Request", bound=BaseModel)
Command = TypeVar("Command", bound=Callable[..., None])


def with_options_of(
    model: type[BaseModel],
    *,
    only: tuple[str, ...] = (),
    without: tuple[str, ...] = (),
    defaults: Mapping[str, Any] | None = None,
) -> Callable[[Command], Command]:
    """Give a command an option for each field of a model, in place of its parameter ``**chosen``.

    The options have the names, descriptions and defaults of the fields, unless ``defaults`` has others;
    ``validated`` checks their limits.
    Fields that hold several values are given several times.
    """
    several, own_defaults = list_fields(model), defaults or {}
    names = only or tuple(name for name in model.model_fields if name not in without)

    def option(name: str) -> inspect.Parameter:
        field, flag = model.model_fields[name], name.replace("_", "-")
        annotated: Any = field.annotation
        switch = annotated in (bool, bool | None)
        flags = f"--{flag}/--no-{flag}" if switch else f"--{flag}"
        kind: Any = list[str] | None if name in several else annotated
        annotation = Annotated[kind, typer.Option(flags, help=escape(field.description or ""))]
        default = own_defaults.get(name, field.default)
        return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)

    def changed(command: Command) -> Command:
        types = get_type_hints(command, include_extras=True)
        own = [
            one.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=types[one.name])
            for one in inspect.signature(command).parameters.values()
            if one.kind is not inspect.Parameter.VAR_KEYWORD
        ]
        parameters = [*own, *map(option, names)]
        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]  # typer reads both
        command.__annotations__ = {one.name: one.annotation for one in parameters}
        return command

    return changed


def validated(model: type[Request], chosen: dict[str, Any]) -> Request:
    """The request with the chosen options; prints what is wrong, option by option, and exits."""
    given = {name: value for name, value in chosen.items() if value not in (None, [])}
    try:
        return model.model_validate(given)
    except ValidationError as error:
        for item in error.errors():
            name = "--" + str(item["loc"][0]).replace("_", "-") if item["loc"] else "Options"
            print_error(f"{name}:", str(item["msg"]))
    raise typer.Exit(1)


def wood_document(path: Path | None) -> WoodDocument | None:
    """The wood of a JSON document; prints what is wrong with it, field by field, and exits."""
    from galewood.wood import WoodError, read_wood_document

    if path is None:
        return None
    try:
        return read_wood_document(path.read_bytes())
    except WoodError as error:
        problems = [f"{name}: {what}" for name, what in error.problems]
        print_error(f"{path} is not a valid wood document.", *problems)
    raise typer.Exit(1)
