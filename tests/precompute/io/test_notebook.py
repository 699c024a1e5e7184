"""``galewood.show``: what may be shown, and the wind of its widget on both sides.

tests/e2e/player/notebook.spec.ts executes the example notebook and shows its widget in a browser.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import galewood
import pytest
import traitlets
from galewood import packaged
from galewood.io.notebook import display
from galewood.io.notebook.trees import shown_table
from galewood.motion.wind import PRESETS, parse_wind
from galewood.table import decode

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.shared_tets import small_tree_glb

SHIPPED = packaged.species_folder() / "shipped"
STILL = {"version": 1, "model": "cosine", "mean_speed_m_s": 0, "direction_deg": 30, "gustiness": 0.5,
         "convection_speed_m_s": 4, "seed": 1}  # fmt: skip
BUILTIN = ("larch", "maple", "maple-forest", "oak-forest", "poplar", "willow")
"""Some of them."""


@pytest.fixture(autouse=True)
def front_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A front end, whether or not the package of the page is built."""
    folder = tmp_path / "front-end"
    folder.mkdir()
    (folder / display.FRONT_END).write_text("export default { render() {} };", encoding="utf-8")

    def of_test(packaged: str, checkout: str) -> Path:
        return folder

    monkeypatch.setattr(display, "data_folder", of_test)


@pytest.fixture(scope="module")
def widget_class() -> Any:
    from galewood.io.notebook import ForestWidget

    return ForestWidget


def test_importing_the_library_does_not_load_the_widget() -> None:
    program = "import sys, galewood; galewood.show; print(json.dumps('anywidget' in sys.modules))"
    output = subprocess.run(
        [sys.executable, "-c", f"import json; {program}"], capture_output=True, check=True, text=True
    )
    assert json.loads(output.stdout) is False


@pytest.mark.parametrize("name", BUILTIN)
def test_a_builtin_tree_is_shown_by_its_name(name: str) -> None:
    table = shown_table(name)
    assert table.data == (SHIPPED / f"{name}.table").read_bytes()
    assert table.render_glb == (SHIPPED / f"{name}.glb").read_bytes()


def test_a_path_and_a_table_are_shown(tmp_path: Path) -> None:
    path, mesh = SHIPPED / "maple-forest.table", SHIPPED / "maple-forest.glb"
    widget = galewood.show(path, trees=12, wind=STILL, height_px=250)
    assert (widget.trees, widget.height_px, widget.wind) == (12, 250, parse_wind(STILL))
    assert (widget.table, widget.mesh) == (path.read_bytes(), mesh.read_bytes())
    (tmp_path / "other.table").write_bytes(path.read_bytes())
    assert galewood.show(str(tmp_path / "other.table"), mesh=mesh).mesh == mesh.read_bytes()
    assert galewood.show(galewood.load(path)).table == path.read_bytes()


def test_a_file_is_preferred_to_a_builtin_tree_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "poplar").write_bytes((SHIPPED / "apricot-forest.table").read_bytes())
    (tmp_path / "poplar.glb").write_bytes((SHIPPED / "apricot-forest.glb").read_bytes())
    monkeypatch.chdir(tmp_path)
    assert shown_table("poplar").metadata["species"] == "apricot"


def test_records_of_the_paper_are_left_out() -> None:
    whole = galewood.MotionTable((GOLDEN_FOLDER / "pole.safetensors").read_bytes(), b"glTF")
    assert whole.table.paper is not None
    shown = shown_table(whole)
    assert decode(shown.data).paper is None and len(shown.data) < len(whole.data)
    assert shown.render_glb == b"glTF"


def test_a_tree_is_shown_with_an_estimate_of_its_motion(tmp_path: Path) -> None:
    (tmp_path / "tree.glb").write_bytes(small_tree_glb())
    tree = galewood.read(tmp_path / "tree.glb", height_m=12)
    widget = galewood.show(tree, trees=1)
    assert decode(widget.table).metadata["provenance"]["stage"] == "beams"
    assert widget.mesh == tree.render_glb


@pytest.mark.parametrize(
    ("tree", "error", "said"),
    [
        ("yew", FileNotFoundError, "maple-forest, oak, oak-forest"),
        (SHIPPED / "poplar.glb", galewood.TableError, "table"),
        (galewood.MotionTable(b""), ValueError, "galewood.load"),
    ],
)
def test_what_cannot_be_shown_is_said(tree: Any, error: type[Exception], said: str) -> None:
    with pytest.raises(error, match=said):
        galewood.show(tree)


@pytest.mark.parametrize("state", [{"trees": 0}, {"trees": 501}, {"height_px": 10}, {"wind": "hurricane"}])
def test_options_out_of_range_are_refused(state: dict[str, Any]) -> None:
    with pytest.raises(traitlets.TraitError):
        galewood.show("apricot-forest", **state)


def test_without_anywidget_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(galewood.NotebookError, match=r"pip install 'galewood\[notebook\]'"):
        galewood.show("poplar")


def test_without_the_front_end_the_error_says_how_to_build_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(display, "data_folder", lambda packaged, checkout: tmp_path)
    with pytest.raises(galewood.NotebookError, match="make player"):
        galewood.show("poplar")


@pytest.fixture
def widget(widget_class: Callable[..., Any]) -> Any:
    return widget_class("export default {};", table=b"table", mesh=b"mesh", trees=1, wind="breeze")


def test_the_wind_is_set_by_name_object_and_document(widget: Any) -> None:
    assert widget.wind == PRESETS["breeze"]
    for given, wind in (
        ("storm-front", PRESETS["storm-front"]),
        (STILL, parse_wind(STILL)),
        (json.dumps(STILL), parse_wind(STILL)),
        (galewood.Wind(mean_speed_m_s=12), galewood.Wind(mean_speed_m_s=12)),
    ):
        widget.wind = given
        assert widget.wind == wind
        assert widget.get_state("wind")["wind"] == wind.document()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("hurricane", "neither a preset nor JSON"),
        ({**STILL, "mean_speed_m_s": 400}, "wind.mean_speed_m_s"),
        (7, "expected an object"),
    ],
)
def test_an_invalid_wind_is_refused_and_the_old_one_stays(widget: Any, given: Any, said: str) -> None:
    with pytest.raises(traitlets.TraitError, match=said):
        widget.wind = given
    assert widget.wind == PRESETS["breeze"]


def test_the_front_end_sets_the_wind(widget: Any) -> None:
    seen: list[galewood.Wind] = []
    widget.observe(lambda change: seen.append(change["new"]), "wind")
    strong = replace(PRESETS["storm-front"], mean_speed_m_s=25.0)
    widget.set_state({"wind": strong.document()})
    assert widget.wind == strong and seen == [strong]


def test_the_files_of_a_widget_stay(widget: Any) -> None:
    for name, value in (("table", b""), ("mesh", b""), ("trees", 2)):
        with pytest.raises(traitlets.TraitError):
            setattr(widget, name, value)
