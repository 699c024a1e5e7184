"""Command line, form, OpenAPI, Python API and the page have the options of one model, with its limits."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any

import galewood
import pytest
import typer
from galewood.io.cli import app
from galewood.options import BuildRequest, ImportRequest, TableRequest, list_fields
from galewood.pipeline.tables import BuildOptions
from galewood_server.app import create_app
from galewood_server.cli import commands
from galewood_server.http.multipart import UPLOAD_FORM
from galewood_server.http.schemas import BuildSettings, TreeChanges
from galewood_server.settings import Settings
from pydantic import BaseModel
from typer.testing import CliRunner

from scripts.write_page_types import TARGET_FILE, generated

COMMANDS: dict[str, type[BaseModel]] = {
    "build": BuildOptions,
    "check": ImportRequest,
    "upload": ImportRequest,
}
LIMITS = ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum", "enum")
Schema = dict[str, Any]


def properties(model: type[BaseModel]) -> dict[str, Schema]:
    """The schema of each field; OpenAPI leaves out defaults that are null."""
    fields = model.model_json_schema(ref_template="#/components/schemas/{model}")["properties"]
    return {name: {k: v for k, v in one.items() if v is not None} for name, one in fields.items()}


def limits_of(schema: Schema) -> Schema:
    """The limits of a value that is not null."""
    parts = [schema, *schema.get("anyOf", [])]
    return {name: part[name] for part in parts for name in LIMITS if name in part}


@pytest.fixture(scope="module")
def openapi(tmp_path_factory: pytest.TempPathFactory) -> Schema:
    return create_app(Settings(data_dir=tmp_path_factory.mktemp("data"))).openapi()


def differences_of_command(program: typer.Typer, name: str, model: type[BaseModel]) -> list[str]:
    """Options of a command that are not those of a model; a wood is the file that describes it."""
    command: Any = typer.main.get_command(program)
    command = command.commands[name] if hasattr(command, "commands") else command
    options = {parameter.name: parameter for parameter in command.params}
    several, found = list_fields(model), list[str]()
    for key, field in model.model_fields.items():
        if key == "wood":
            found += [] if "wood_properties" in options else [key]
            continue
        option, default = options.get(key), None if key in several else field.default
        expected = ([f"--{key.replace('_', '-')}"], field.description, default)
        if option is None or (option.opts, option.help, option.default) != expected:
            found.append(key)
    return found


def differences_of_form(form: Schema) -> list[str]:
    """Fields of the form of an upload that are not those of the model."""
    fields = form["requestBody"]["content"]["multipart/form-data"]["schema"]["properties"]
    model = properties(TreeChanges)
    found = sorted(set(fields) ^ {"file", *model})
    for name in sorted(set(model) & set(fields)):
        as_text = {"type": "string"} if name in list_fields(TreeChanges) else {}
        same = limits_of(fields[name]) == limits_of(model[name]) and as_text.items() <= fields[name].items()
        found += [] if same and fields[name]["description"].startswith(model[name]["description"]) else [name]
    return found


def differences_of_openapi(document: Schema) -> list[str]:
    """Options in the description of the service that are not those of the models."""
    schemas, found = document["components"]["schemas"], list[str]()
    for name, model in (("TreeChanges", ImportRequest), ("BuildSettings", BuildRequest)):
        described = schemas[name]["properties"]
        found += [key for key, field in properties(model).items() if described.get(key) != field]
    return found


def differences_of_call(function: Callable[..., Any], model: type[BaseModel]) -> list[str]:
    """Keywords of a function that are not the fields of a model."""
    given = inspect.signature(function).parameters
    return [
        name
        for name, field in model.model_fields.items()
        if name not in given or given[name].default != field.default
    ]


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_have_the_options_of_the_model(name: str) -> None:
    assert commands  # registers `upload`
    assert differences_of_command(app, name, COMMANDS[name]) == []


def test_limits_hold_on_the_command_line(tmp_path: Path) -> None:
    mesh = tmp_path / "tree.obj"
    mesh.write_text("v 0 0 0\n")
    result = CliRunner().invoke(app, ["check", str(mesh), "--height-m", "121"])
    assert result.exit_code == 1 and "--height-m: Input should be less than or equal to 120" in result.output


def test_the_form_has_the_fields_of_the_model() -> None:
    assert differences_of_form(UPLOAD_FORM) == []


def test_the_service_describes_the_fields_of_the_model(openapi: Schema) -> None:
    assert differences_of_openapi(openapi) == []
    assert set(BuildSettings.model_fields) == set(BuildRequest.model_fields)


def test_python_calls_have_the_fields_of_the_model() -> None:
    assert differences_of_call(galewood.read, ImportRequest) == []
    assert differences_of_call(galewood.build, TableRequest) == []


def test_the_types_of_the_page_are_those_of_the_service(openapi: Schema) -> None:
    assert TARGET_FILE.read_text(encoding="utf-8") == generated(openapi), "run `make page-types`"


def by_hand(
    path: Path, *, species: str | None = None, height_m: Annotated[float, typer.Option(help="Height.")] = 10.0
) -> None:
    """A command and a function whose options are typed again, and forgotten."""


def test_options_that_are_typed_again_are_found(openapi: Schema) -> None:
    program = typer.Typer()
    program.command()(by_hand)
    assert {"species", "height_m", "complete"} <= set(
        differences_of_command(program, "by-hand", ImportRequest)
    )
    assert {"height_m", "complete"} <= set(differences_of_call(by_hand, ImportRequest))

    document = deepcopy(openapi)
    height = document["components"]["schemas"]["TreeChanges"]["properties"]["height_m"]["anyOf"][0]
    height["maximum"] = 150
    assert differences_of_openapi(document) == ["height_m"]
    assert TARGET_FILE.read_text(encoding="utf-8") != generated(document)

    form = deepcopy(UPLOAD_FORM)
    fields = form["requestBody"]["content"]["multipart/form-data"]["schema"]["properties"]
    fields["height_m"]["maximum"] = 150
    del fields["complete"]
    assert differences_of_form(form) == ["complete", "height_m"]
