"""The commands `galewood upload`, `doctor` and `key`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from galewood.io.cli import (
    JsonOut,
    Mesh,
    console,
    print_error,
    progress_bar,
    progress_reporter,
    validated,
    with_options_of,
    write_figures,
)
from galewood.options import ImportRequest

from galewood_server.cli.extras import end_with, needs_extras, read_settings


@with_options_of(ImportRequest)
def upload(
    mesh: Mesh,
    server: Annotated[str, typer.Option(help="URL of the service.")] = "http://127.0.0.1:8000",
    key: Annotated[
        str | None, typer.Option(envvar="GALEWOOD_KEY", help="API key, if the service requires one.")
    ] = None,
    inspect: Annotated[
        bool, typer.Option(help="Only import the mesh and print the report; compute nothing.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Write the table to this file.")] = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Upload a mesh to a service, wait for its table and optionally download it."""
    with needs_extras():
        import httpx

        from galewood_server.cli.client import Client, ServiceError

    options = validated(ImportRequest, chosen)
    try:
        with Client(server, key) as client:
            uploaded = client.upload(mesh, **options.model_dump(exclude_none=True))
            uploaded = uploaded if inspect else _compute(client, uploaded["id"])
            if out is not None and uploaded["table_sha256"]:
                out.write_bytes(client.whole_table(uploaded))
    except ServiceError as error:
        print_error(error.title, error.hint)
        raise typer.Exit(1) from None
    except httpx.TransportError as error:
        print_error(f"{server} does not respond", f"({error})")
        raise typer.Exit(1) from None
    write_figures(json_out, uploaded)
    console.print_json(data=uploaded)


def _compute(client: Any, tree_id: str) -> dict[str, Any]:
    with progress_bar() as bar:
        report = progress_reporter(bar)
        started = client.start(tree_id)
        job = started
        for job in client.follow(started["id"]):
            report(job["fraction"], job["message"])
    if job["state"] != "done":
        console.print(
            f"[red]The computation did not finish[/red] ({job['state']}): {job['error'] or job['message']}"
        )
        raise typer.Exit(1)
    return client.tree(tree_id)


def doctor(
    repair: Annotated[
        bool, typer.Option(help="Remove corrupt and unreferenced files, clear references to missing ones.")
    ] = False,
    json_out: JsonOut = None,
) -> None:
    """Check the file stores against the database. Exit status 1 if there are faults, otherwise 0."""
    with needs_extras():
        from galewood_server.cli.doctor import run_checks
        from galewood_server.storage import start_failure

    settings = read_settings()
    try:
        findings = run_checks(settings, repair=repair)
    except Exception as error:
        sentence = start_failure(error, settings)
        if sentence is None:
            raise
        end_with(sentence)
    for one in findings:
        mark = "repaired" if one.repaired else "FAULT" if one.is_fault else "note"
        console.print(f"{mark:>8}  {one.kind}: {one.what}", soft_wrap=True)
    faults = sum(one.is_fault for one in findings)
    console.print(f"{faults} fault(s), {sum(one.repaired for one in findings)} repaired")
    rows = [{"kind": one.kind, "what": one.what, "repaired": one.repaired} for one in findings]
    write_figures(json_out, {"findings": rows, "faults": faults})
    raise typer.Exit(1 if faults else 0)


def key() -> None:
    """Create an API key: give the key to a client and add its hash to GALEWOOD_API_KEYS."""
    with needs_extras():
        from galewood_server.access import new_key

    secret, sha256 = new_key()
    typer.echo(f"key      {secret}\nSHA-256  {sha256}")
