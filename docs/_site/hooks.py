"""MkDocs hook: pages whose text is a file outside docs/, named by `source:` in their front matter.

Links in that file are relative to it. They are rewritten to the site's pages; links to source code, which the
site does not contain, become plain text.
"""

from __future__ import annotations

import os
import re
from pathlib import Path, PurePosixPath
from typing import Any

from mkdocs.structure.files import File

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
PAGES = {
    "README.md": "index.md",
    "ARCHITECTURE.md": "architecture.md",
    "CHANGELOG.md": "changelog.md",
    "web/README.md": "viewer.md",
    "assets/species/README.md": "species.md",
    "spec/README.md": "formats/index.md",
}
FOLDERS = {"docs/": "", "spec/formats/": "formats/"}
"""Folders of the repository and where their files are on the site."""
SCHEMA_FILES = ("formats/wind.schema.json", "formats/EXT_modal_dynamics.schema.json")


def on_files(files: Any, config: Any) -> Any:
    """The site's pages, and the schemas that they offer for download."""
    for schema in SCHEMA_FILES:
        source = Path(config.config_file_path).parent / "spec" / schema
        files.append(File.generated(config, schema, abs_src_path=str(source)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """The text of the page's `source`, if it has one."""
    source = page.meta.get("source")
    if not source:
        return markdown
    root = Path(config.config_file_path).parent
    return resolved(root.joinpath(source).read_text(encoding="utf-8"), source, page.file.src_uri)


def resolved(text: str, source: str, page: str) -> str:
    """``text`` of the file ``source`` with its links as seen from ``page``."""

    def link(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, hash_mark, anchor = target.partition("#")
        path = os.path.normpath(PurePosixPath(source).parent / path)
        if path in ("docs", "docs/design"):
            path = f"{path}/index.md"
        where = PAGES.get(path) or next(
            (there + path.removeprefix(here) for here, there in FOLDERS.items() if path.startswith(here)),
            None,
        )
        if where is None:
            return label
        relative = os.path.relpath(where, PurePosixPath(page).parent)
        return f"{mark}[{label}]({relative}{hash_mark}{anchor})"

    return LINK.sub(link, text)
