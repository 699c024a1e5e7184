"""Forms that are made to be slow to read."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import anyio
import pytest
from galewood_server.http.multipart import MOST_FIELDS

from tests.server.support.in_process import application

HEADERS = {"content-type": "multipart/form-data; boundary=x"}
HEAD = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.obj"\r\n\r\n'
END = b"\r\n--x--\r\n"


async def pieces(body: bytes, size: int) -> AsyncIterator[bytes]:
    for begin in range(0, len(body), size):
        yield body[begin : begin + size]


@pytest.mark.parametrize("size", [1, 7, 1 << 20])
def test_a_form_with_more_delimiters_than_parts_is_refused(tmp_path: Path, size: int) -> None:
    async def run() -> None:
        async with application(tmp_path) as (_, api):
            for count in (MOST_FIELDS, MOST_FIELDS + 1):  # besides the first and the last one
                body = HEAD + b"\r\n--x-" * count + END
                answer = await api.post("/api/trees", content=pieces(body, size), headers=HEADERS)
                assert answer.status_code == (201 if count == MOST_FIELDS else 400), answer.text
            assert answer.json()["code"] == "broken-form"

    anyio.run(run)


def test_a_file_may_hold_what_only_resembles_the_delimiter(tmp_path: Path) -> None:
    async def run() -> None:
        async with application(tmp_path) as (_, api):
            body = HEAD + b"\r\n--y\r\n-x\n--x" * 100 + END
            answer = await api.post("/api/trees", content=pieces(body, 5), headers=HEADERS)
            assert answer.status_code == 201, answer.text

    anyio.run(run)
