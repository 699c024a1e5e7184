"""Command-line options that follow from the fields of a request model (galewood.options)."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from pydantic import BaseModel, ValidationError

from galewood.cli.tools import console

SHORT_NAMES = {
    "target_tets": "--tets",
    "sampled_elements": "--elements",
    "design_speed_m_s": "--design-speed",
    "frames": "--wind-frames",
    "wood_materials": "--wood",
}
"""Shorter or older names of options."""
LISTS = ("wood_materials", "leaves", "drop")
"""Options that can be given several times, once per name or id."""
Mesh = Annotated[
    Path,
    typer.Argument(
        exists=True,
        dir_okay=False,
        help="GLB, glTF, OBJ, PLY, STL, FBX, DAE, 3DS or ZIP; or a scanned tree's cylinders (MAT, CSV).",
    ),
]
Request = TypeVar("Request", bound=BaseModel)


def validated(model: type[Request], chosen: dict[str, Any]) -> Request:
    """The request with the chosen options; prints what is wrong, field by field, and exits."""
    given = {name: value for name, value in chosen.items() if value not in (None, [])}
    try:
        return model.model_validate(given)
    except ValidationError as error:
        for item in error.errors():
            name = "--" + str(item["loc"][0]).replace("_", "-") if item["loc"] else "Options"
            console.print(f"[red]{name}[/red]: {item['msg']}")
    raise typer.Exit(1)


def named_parameter(name: str, annotation: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    """A parameter of a command, as typer reads it from a signature."""
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def request_parameters(model: type[BaseModel], without: tuple[str, ...] = ()) -> list[inspect.Parameter]:
    """An option for every field of a request, of the same name, with the same description and bounds."""
    found: list[inspect.Parameter] = []
    for name, field in model.model_fields.items():
        if name in without:
            continue
        flag = name.replace("_", "-")
        switch = field.annotation == (bool | None)
        names = [f"--{flag}/--no-{flag}" if switch else f"--{flag}"]
        names += [SHORT_NAMES[name]] if name in SHORT_NAMES else []
        kind = list[str] | None if name in LISTS else field.annotation
        option = typer.Option(*names, help=field.description)
        found.append(named_parameter(name, Annotated[kind, option], None))
    return found
