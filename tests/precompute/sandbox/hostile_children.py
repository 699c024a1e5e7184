"""Functions that a confined child runs in tests: what they write is not what the parent expects."""

from __future__ import annotations

import json
import os
import sys
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from galewood.sandbox import Arrays
from galewood.sandbox.limited_process import REFUSED_EXIT_CODE

HUGE = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000,), }"


def deep_folders() -> None:
    for _ in range(3000):
        Path("d").mkdir()
        os.chdir("d")


def wait_in_deep_folders() -> None:
    deep_folders()
    time.sleep(600)


def unlinked_files() -> None:
    for number in range(200):
        file = Path(str(number)).open("wb")  # noqa: SIM115  # kept open
        file.write(b"x" * (1 << 20))
        kept.append(file)
        file.flush()
        Path(str(number)).unlink()
    time.sleep(600)


kept: list[object] = []


def wrong_error() -> None:
    Path("error.json").write_text('{"x": 1}')
    os._exit(REFUSED_EXIT_CODE)


def error_of_unknown_reason() -> None:
    fields = {"code": "a", "reason": "b", "title": "c", "hint": "d"}
    Path("error.json").write_text(json.dumps(fields))
    os._exit(REFUSED_EXIT_CODE)


def no_error() -> None:
    os._exit(REFUSED_EXIT_CODE)


def no_result() -> None:
    os._exit(0)


def damaged_result() -> None:
    Path("out.npz").write_bytes(b"PK\x03\x04 nothing")
    os._exit(0)


def compressed_result() -> None:
    with Path("out.npz").open("wb") as file:
        np.savez_compressed(file, zeros=np.zeros(1 << 24))
    os._exit(0)


def huge_result() -> None:
    with zipfile.ZipFile("out.npz", "w") as archive:
        head = HUGE.ljust(117) + "\n"
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00v\x00" + head.encode())
    os._exit(0)


def result_of_nested_header() -> None:
    head = ("{'descr': " + "(" * 9000 + ")").ljust(9999) + "\n"
    with zipfile.ZipFile("out.npz", "w") as archive:
        size = len(head).to_bytes(2, "little")
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00" + size + head.encode())
    os._exit(0)


def encrypted_result() -> None:
    np.savez("out.npz", a=np.zeros(3))
    data = bytearray(Path("out.npz").read_bytes())
    data[6] |= 1  # general purpose flags of the member and of its entry in the directory
    data[data.find(b"PK\x01\x02") + 8] |= 1
    Path("out.npz").write_bytes(data)
    os._exit(0)


def text_result() -> None:
    with zipfile.ZipFile("out.npz", "w") as archive:
        archive.writestr("a.txt", "text")
    os._exit(0)


def pickled_result() -> None:
    np.savez("out.npz", allow_pickle=True, a=np.array([{}], dtype=object))
    os._exit(0)


DEEDS: dict[str, Callable[[], None]] = {
    deed.__name__: deed
    for deed in (
        deep_folders, wait_in_deep_folders, unlinked_files, wrong_error, error_of_unknown_reason, no_error,
        no_result, damaged_result, compressed_result, huge_result, result_of_nested_header, encrypted_result,
        text_result, pickled_result,
    )
}  # fmt: skip


def misbehave(arguments: Arrays) -> Arrays:
    sys.stderr.write("x" * 100_000)
    DEEDS[str(arguments["deed"])]()
    return {}
