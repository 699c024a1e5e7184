"""The Compose file: what Docker Compose and the kernel refuse, checked without an engine.

The file's merge keys are resolved as YAML does; variables are substituted as in the Compose specification.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml
from galewood_server.settings import Settings

REPOSITORY = Path(__file__).resolve().parents[2]
SECRETS = {"POSTGRES_PASSWORD": "p" * 32, "S3_SECRET": "5" * 32, "GALEWOOD_API_KEYS": "0" * 64}
# file capabilities of the images' programs: getcap /usr/bin/caddy in caddy:2-alpine
FILE_CAPABILITIES = {"caddy": "NET_BIND_SERVICE"}
_VARIABLE = re.compile(r"\$\{(\w+)(?::([-?])([^}]*))?\}")


def substituted(text: str) -> str:
    """Variables replaced as Compose does. KeyError for one that is neither given nor has a default."""

    def value(found: re.Match[str]) -> str:
        name, kind, default = found.groups()
        return SECRETS.get(name) or (default if kind == "-" else SECRETS[name])

    return _VARIABLE.sub(value, text)


def composition() -> dict[str, Any]:
    return yaml.safe_load(substituted((REPOSITORY / "docker-compose.yml").read_text()))


SERVICES: dict[str, dict[str, Any]] = composition()["services"]


def mounts(service: dict[str, Any]) -> list[tuple[str, str, str]]:
    """(source, target, options) of every short-form volume."""
    parts = [str(volume).split(":") for volume in service.get("volumes", [])]
    return [(part[0], part[1], part[2] if len(part) > 2 else "") for part in parts]


@pytest.mark.parametrize("name", SERVICES)
def test_programs_with_file_capabilities_keep_them_in_the_bounding_set(name: str) -> None:
    service = SERVICES[name]
    needed = FILE_CAPABILITIES.get(service["image"].split(":")[0])
    assert "ALL" in service["cap_drop"] and "no-new-privileges:true" in service["security_opt"]
    assert needed is None or needed in service.get("cap_add", [])


@pytest.mark.parametrize("name", SERVICES)
def test_read_only_services_have_no_inline_configs(name: str) -> None:
    whole, service = composition(), SERVICES[name]
    assert service["read_only"] is True
    for kind in ("configs", "secrets"):
        for entry in service.get(kind, []):
            source = entry["source"] if isinstance(entry, dict) else entry
            assert "file" in whole[kind][source], f"Compose cannot copy {source} into a read-only container"


@pytest.mark.parametrize("name", SERVICES)
def test_every_mount_exists(name: str) -> None:
    service = SERVICES[name]
    for source, target, options in mounts(service):
        if source.startswith((".", "/")):
            assert (REPOSITORY / source).is_file(), f"{source} does not exist; Docker would make a folder"
            assert options == "ro" and os.access(REPOSITORY / source, os.R_OK)
        else:
            assert source in composition()["volumes"]
        assert target.startswith("/")
    targets = {target for _, target, _ in mounts(service)}
    scripts = [word for word in service.get("entrypoint", []) if word.endswith(".sh")]
    assert targets.issuperset(scripts)


def test_volumes_that_are_given_to_a_user_hold_nothing_of_the_image() -> None:
    """Docker copies folders of an image into a fresh volume as it creates the container: before `prepare`."""
    given = {source: target for source, target, _ in mounts(SERVICES["prepare"])}
    command = " ".join(SERVICES["prepare"]["command"])
    assert all(target in command for target in given.values())
    users = [name for name in SERVICES if name != "prepare"]
    found = [mount for name in users for mount in mounts(SERVICES[name]) if mount[0] in given]
    assert {source for source, _, _ in found} == set(given)
    assert all(options == "nocopy" for _, _, options in found)


def test_dependencies_exist_and_can_be_met() -> None:
    for name, service in SERVICES.items():
        for other, condition in service.get("depends_on", {}).items():
            assert other in SERVICES and other != name
            if condition["condition"] == "service_completed_successfully":
                assert SERVICES[other]["restart"] == "no"
            elif "build" not in SERVICES[other]:  # our image has a health check of its own
                assert "healthcheck" in SERVICES[other], f"{name} waits for {other} to be healthy"


def test_the_bucket_is_created_before_a_server_starts() -> None:
    for name in ("server-a", "server-b"):
        store = SERVICES[name]["environment"]["GALEWOOD_STORE_URL"]
        assert SERVICES[name]["depends_on"]["bucket"]["condition"] == "service_completed_successfully"
        assert store == f"s3://{SERVICES['bucket']['environment']['BUCKET']}"
    assert SERVICES["bucket"]["depends_on"]["objects"]["condition"] == "service_healthy"


def fake_weed(folder: Path, script: str) -> dict[str, str]:
    program = folder / "weed"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    return {"PATH": f"{folder}:{os.environ['PATH']}", "PAUSE_S": "0", "BUCKET": "galewood"}


def run_script(name: str, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    command = ["/bin/sh", str(REPOSITORY / "deploy" / name)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=20)


def test_the_bucket_script_fails_unless_the_bucket_exists(tmp_path: Path) -> None:
    made = tmp_path / "made"
    works = (
        f'read line; case $line in *create*) touch {made};; *) test -e {made} && echo "galewood size:0"; esac'
    )
    assert run_script("create-bucket.sh", fake_weed(tmp_path, works)).returncode == 0
    broken = fake_weed(tmp_path, "cat >/dev/null; echo error: no filer")
    assert run_script("create-bucket.sh", broken).returncode == 1


def test_the_object_store_gets_its_credentials(tmp_path: Path) -> None:
    file = tmp_path / "s3.json"
    environment = fake_weed(tmp_path, 'echo "$@"') | {"CREDENTIALS": str(file), "S3_SECRET": "ab/+=12"}
    started = run_script("object-store.sh", environment)
    assert f"-s3.config={file}" in started.stdout and file.stat().st_mode & 0o77 == 0
    (user,) = json.loads(file.read_text())["identities"]
    assert user["credentials"] == [{"accessKey": "galewood", "secretKey": "ab/+=12"}]
    refused = run_script("object-store.sh", environment | {"S3_SECRET": 'a"b'})
    assert refused.returncode == 2 and "S3_SECRET" in refused.stderr


def test_the_object_store_is_not_killed_when_it_stops(tmp_path: Path) -> None:
    """SeaweedFS waits for its clients; 30 s is its limit for requests that are under way."""
    started = run_script("object-store.sh", fake_weed(tmp_path, 'echo "$@"') | {"S3_SECRET": "a",
                         "CREDENTIALS": str(tmp_path / "s3.json")})  # fmt: skip
    (wait_s,) = re.findall(r"-volume\.preStopSeconds=(\d+)", started.stdout)
    assert 30 + int(wait_s) < int(SERVICES["objects"]["stop_grace_period"].removesuffix("s"))
    assert int(wait_s) < 10


def test_the_proxy_sends_all_clients_of_a_shared_forest_to_one_server() -> None:
    """The page names the forest in the query of its socket (web/player/src/worker/stream/forestUrl.ts)."""
    caddyfile = (REPOSITORY / "deploy" / "Caddyfile").read_text()
    (policy,) = re.findall(r"lb_policy ([^{}\n]*?)\s*\{\s*fallback (\w+)\s*\}", caddyfile)
    assert policy == ("query share", "client_ip_hash")


def test_the_proxy_lets_every_body_pass_that_the_service_accepts() -> None:
    """Its times are for whole bodies: a least rate, as the service has it, is not among its options."""
    caddyfile = (REPOSITORY / "deploy" / "Caddyfile").read_text()
    (size_mib,) = map(int, re.findall(r"max_size (\d+)MiB", caddyfile))
    settings = Settings()
    assert size_mib * 2**20 > settings.upload_bytes
    for limit in ("read_body", "write"):
        (minutes,) = map(int, re.findall(rf"\t{limit} (\d+)m\n", caddyfile))
        assert minutes * 60 * settings.body_bytes_per_s > size_mib * 2**20
    (header_s,) = map(float, re.findall(r"read_header (\d+)s", caddyfile))
    assert header_s <= settings.header_s
