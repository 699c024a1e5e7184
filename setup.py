"""The build's one step beyond pyproject.toml: the page, the species, their generator and the notebook's front
end, as data.

They stand in the repository once, as web/dist (built), assets/species, tools/species/dist (built) and
web/player/dist/notebook (built); a wheel gets copies below the packages, where galewood.packaged looks first.
An editable installation gets none.
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist
from setuptools.errors import SetupError

HERE = Path(__file__).resolve().parent
# folder in the wheel, folder of the repository, a file that it must have
DATA = (
    ("galewood_server/data/page", "web/dist", "index.html"),
    ("galewood/data/species", "assets/species", "species.json"),
    ("galewood/data/grower", "tools/species/dist", "grower.mjs"),
    ("galewood/data/notebook", "web/player/dist/notebook", "widget.js"),
)


class BuildWithData(build_py):
    """Starts from an empty folder, as setuptools would pack what an earlier build left there."""

    def run(self) -> None:
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()
        if not self.editable_mode:
            for name, source, needed in DATA:
                if not (HERE / source / needed).is_file():
                    raise SetupError(f"{source}/{needed} is missing: `make wheel` builds what a wheel needs")
                shutil.copytree(HERE / source, Path(self.build_lib, name))


class NoSourceArchive(sdist):
    """Refused in words: an archive of the Python sources alone could not be built into a wheel that works."""

    def run(self) -> None:
        raise SetupError("there is no source archive: build the wheel from the repository with `make wheel`")


setup(
    cmdclass={"build_py": BuildWithData, "sdist": NoSourceArchive},
    options={"build": {"build_base": "build/python"}},
)
