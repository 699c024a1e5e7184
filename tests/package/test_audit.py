"""scripts/audit, with programs in place of pip-audit and npm."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
Audit = Callable[[str, str], subprocess.CompletedProcess[str]]

SOUND = [{"name": "pillow", "version": "13.0.0", "vulns": []}]
VULNERABLE = [
    {"name": "pillow", "version": "9.0.0", "vulns": [{"id": "PYSEC-1", "fix_versions": ["9.0.1"]}]},
    *SOUND,
]
UNKNOWN = [{"name": "pillow", "skip_reason": "Dependency not found"}, *SOUND]
ADVISORY = {"title": "Reads any file", "url": "/advisories/1"}
VULNERABLE_PAGE = {
    "vite": {"range": "<6.0.1", "severity": "high", "via": [ADVISORY]},
    "vitest": {"range": "<3", "severity": "high", "via": ["vite"]},
}


def pip_answer(dependencies: list[dict[str, Any]]) -> str:
    return printing({"dependencies": dependencies, "fixes": []})


def npm_answer(vulnerabilities: dict[str, Any]) -> str:
    return printing({"auditReportVersion": 2, "vulnerabilities": vulnerabilities})


def printing(document: dict[str, Any]) -> str:
    return f"cat <<'END'\n{json.dumps(document)}\nEND"


@pytest.fixture
def audit(tmp_path: Path) -> Audit:
    """Run the script with what pip-audit and npm do, in shell."""

    def run(pip_audit: str, npm: str) -> subprocess.CompletedProcess[str]:
        for name, does in {"pip-audit": pip_audit, "npm": npm}.items():
            program = tmp_path / name
            program.write_text(f'#!/bin/sh\necho "{name} $*" >> {tmp_path}/asked\n{does}\n')
            program.chmod(0o755)
        environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
        command = [sys.executable, str(REPOSITORY / "scripts" / "audit")]
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)

    return run


def test_every_lock_file_is_looked_up(audit: Audit, tmp_path: Path) -> None:
    ran = audit(pip_answer(SOUND), npm_answer({}))
    assert (ran.returncode, ran.stderr) == (0, "")
    asked = (tmp_path / "asked").read_text()
    locks = list(REPOSITORY.glob("requirements/*.txt"))
    assert len(locks) > 5 and all(str(lock) in asked for lock in locks)
    assert asked.count("npm audit") == 1
    assert ran.stdout.count("no known advisories") == len(locks) + 1


@pytest.mark.parametrize("answers", [(VULNERABLE, {}), (SOUND, VULNERABLE_PAGE)])
def test_an_advisory_fails(audit: Audit, answers: tuple[list[dict[str, Any]], dict[str, Any]]) -> None:
    ran = audit(pip_answer(answers[0]) + "\nexit 1", npm_answer(answers[1]) + "\nexit 1")
    assert ran.returncode == 1 and "packages with advisories were found" in ran.stderr
    lines = ran.stdout.splitlines()
    if answers[1]:
        assert "package-lock.json: vite <6.0.1: high; Reads any file (/advisories/1)" in lines
        assert "package-lock.json: vitest <3: high; vite" in lines
    else:
        assert "requirements/base.txt: pillow 9.0.0: PYSEC-1, fixed in 9.0.1" in lines


def test_a_package_that_the_database_does_not_know_is_no_success(audit: Audit) -> None:
    """pip-audit itself ends with 0 and `No known vulnerabilities found`."""
    ran = audit(pip_answer(UNKNOWN), npm_answer({}))
    assert ran.returncode == 2 and "not all packages could be looked up" in ran.stderr
    assert (
        "requirements/base.txt: not looked up: the database does not know 1 packages (pillow)" in ran.stderr
    )


@pytest.mark.parametrize("npm", [printing({"message": "405 Method Not Allowed"}), "echo offline >&2"])
def test_no_answer_is_no_success(audit: Audit, npm: str) -> None:
    ran = audit("echo 'Failed to resolve' >&2; exit 1", npm + "\nexit 1")
    assert ran.returncode == 2 and ran.stdout == ""
    assert "requirements/base.txt: not looked up: Failed to resolve" in ran.stderr
    assert "package-lock.json: not looked up: " + ("405" if "405" in npm else "offline") in ran.stderr


def test_an_advisory_counts_more_than_no_answer(audit: Audit) -> None:
    assert audit(pip_answer(VULNERABLE), "exit 1").returncode == 1
