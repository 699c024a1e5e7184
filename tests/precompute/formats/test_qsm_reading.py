"""Every format gives the same cylinders; what is not one tree is refused."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.formats.qsm.cylinders import Cylinders, checked_tree
from galewood.formats.qsm.tables import read_table
from galewood.formats.qsm.treeqsm import HDF5_HEADER, read_treeqsm
from galewood.options import Axis, ImportRequest
from galewood.tree.importer import read_tree
from galewood.tree.sandboxed import import_mesh_sandboxed
from galewood.util import MeshError

from tests.precompute.fixtures import cylinder_models as make

LEAFLESS = ImportRequest(add_leaves=False)


def cylinders_of(name: str, data: bytes) -> Cylinders:
    raw = read_treeqsm(data)[0] if name.endswith(".mat") else read_table(data)
    return checked_tree(raw)[0]


@pytest.mark.parametrize("name", make.WRITERS)
def test_every_format_gives_the_same_cylinders(name: str) -> None:
    model = make.moved(make.y_model(), [300.0, -20.0, 250.0])
    found = cylinders_of(name, make.WRITERS[name](model))
    np.testing.assert_allclose(found.start_m, model.start_m, atol=1e-9)
    np.testing.assert_allclose(found.end_m, model.end_m, atol=1e-9)
    np.testing.assert_allclose(found.radius_m, model.radius_m, rtol=1e-6)
    assert (found.parent == model.parent).all()


@pytest.mark.parametrize("name", make.WRITERS)
def test_the_report_has_exact_volume_and_diameter(name: str) -> None:
    model = make.y_model()
    tree = read_tree(make.WRITERS[name](model), name, LEAFLESS)
    exact = float((np.pi * model.radius_m**2 * model.length_m).sum())
    qsm = tree.report["qsm"]
    assert qsm["wood_volume_m3"] == pytest.approx(exact, rel=1e-6)
    assert qsm["dbh_cm"] == pytest.approx(18.0, rel=1e-6)
    assert (qsm["cylinders"], qsm["branches"]) == (7, 2)
    assert qsm["height_m"] == pytest.approx(4.0)
    assert tree.report["unit"] == {
        "value": "m", "metres_per_unit": 1.0, "reason": "cylinder models are in metres", "assumed": False,
        "unsure": False,
    }  # fmt: skip
    assert ("models" in " ".join(tree.report["warnings"])) == (name == "array.mat")


def test_the_branch_column_outweighs_the_extension() -> None:
    """Some programs name the first cylinder of a side branch as the extension."""
    model = make.y_model()
    text = make.archi(replace(model, radius_m=np.full(7, 0.05))).decode().splitlines()
    branch, extension = [1, 1, 1, 1, 2, 2, 2], [2, 5, 4, 0, 6, 7, 0]
    rows = [f"{line},{a},{b}" for line, a, b in zip(text[1:], branch, extension, strict=True)]
    found = read_table("\n".join([text[0] + ",axis_ID,extension_ID", *rows]).encode())
    assert found.extension.tolist() == model.extension.tolist()


def test_a_few_loose_cylinders_are_dropped_and_reported() -> None:
    model = make.y_model()
    twig = make.chain(np.array([[2.0, 0, 3.0], [2.1, 0, 3.1]]), [0.005])
    tree = read_tree(make.archi(make.beside(model, twig)), "a.csv", LEAFLESS)
    assert tree.report["qsm"]["dropped"]["loose_cylinders"] == 1
    assert any("no connection" in warning for warning in tree.report["warnings"])


def changed(**fields: object) -> bytes:
    return make.archi(replace(make.y_model(), **fields))


def with_value(name: str, at: int, value: float) -> bytes:
    rows = getattr(make.y_model(), name).copy()
    rows[at] = value
    return changed(**{name: rows})


def hdf5() -> bytes:
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + HDF5_HEADER


def damaged() -> bytes:
    data = bytearray(make.treeqsm(make.y_model()))
    data[140:] = data[140:][::-1]
    return bytes(data)


def lengths(**fields: np.ndarray) -> bytes:
    return make.mat({"QSM": {"cylinder": make.struct_of(make.y_model()) | fields}})


REFUSED = {
    "a cycle": ("a.csv", changed(parent=np.array([-1, 0, 3, 2, 1, 4, 5])), "cylinder-cycle"),
    "only a cycle": ("a.csv", changed(parent=np.array([6, 0, 1, 2, 1, 4, 5])), "cylinder-cycle"),
    "its own parent": ("a.csv", changed(parent=np.array([-1, 0, 1, 3, 1, 4, 5])), "cylinder-cycle"),
    "no such parent": ("a.csv", with_value("parent", 3, 90), "cylinder-parent"),
    "a negative radius": ("a.csv", with_value("radius_m", 2, -0.01), "cylinder-radius"),
    "a radius of zero": ("a.csv", with_value("radius_m", 2, 0.0), "cylinder-radius"),
    "not a number": ("a.csv", with_value("radius_m", 2, np.nan), "cylinder-not-finite"),
    "two trees": (
        "a.csv",
        make.archi(make.beside(make.y_model(), make.moved(make.y_model(), [9.0, 0, 0]))),
        "several-roots",
    ),
    "millimetres": ("a.csv", make.archi(make.y_model().scaled(1000.0)), "cylinder-unit"),
    "radii in millimetres": ("a.csv", changed(radius_m=1000 * make.y_model().radius_m), "cylinder-thick"),
    "upside down": (
        "a.csv",
        changed(start_m=-make.y_model().start_m, end_m=-make.y_model().end_m),
        "upside-down",
    ),
    "a child far away": ("a.csv", with_value("start_m", 5, 3.0), "cylinder-gap"),
    "all thin": ("a.csv", changed(radius_m=np.full(7, 0.004)), "all-thin"),
    "missing columns": ("a.csv", b"startX,startY,startZ,radius\n0,0,0,1\n", "cylinder-columns"),
    "any table": ("a.csv", b"species,mass\noak,3\n", "cylinder-columns"),
    "no rows": ("a.csv", make.archi(make.y_model()).splitlines()[0], "no-cylinders"),
    "words": ("a.csv", make.archi(make.y_model()).replace(b"0.07", b"thin"), "csv-syntax"),
    "a short row": ("a.csv", make.archi(make.y_model()) + b"8,7,1\n", "csv-syntax"),
    "the same ID twice": (
        "a.csv", make.archi(make.y_model()) + make.archi(make.y_model()).splitlines()[2], "cylinder-id",
    ),
    "too many": ("a.csv", make.archi(make.pole(count=20_001)), "too-many-cylinders"),
    "version 7.3": ("a.mat", hdf5(), "mat-version"),
    "damaged": ("a.mat", damaged(), "unreadable"),
    "truncated": ("a.mat", make.treeqsm(make.y_model())[:300], "unreadable"),
    "another variable": ("a.mat", make.mat({"a": np.eye(3), "b": "text", "c": {"d": 1}}), "no-cylinders"),
    "different lengths": ("a.mat", lengths(length=np.ones((5, 1))), "cylinder-fields"),
    "text as radius": ("a.mat", lengths(radius=np.array(["a", "b"], object)), "cylinder-fields"),
    "a negative length": ("a.mat", lengths(length=np.full((7, 1), -1.0)), "cylinder-length"),
    "no axis": ("a.mat", lengths(axis=np.zeros((7, 3))), "cylinder-length"),
    "half a parent": ("a.mat", lengths(parent=np.arange(7)[:, None] + 0.5), "cylinder-parent"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_a_tree_is_refused_with_a_hint(case: str) -> None:
    name, data, code = REFUSED[case]
    with pytest.raises(MeshError) as caught:
        read_tree(data, name)
    assert caught.value.code == code
    assert caught.value.title.endswith(".") and caught.value.hint.endswith(".")


def test_cylinder_files_are_read_in_the_sandbox() -> None:
    tree, glb = import_mesh_sandboxed(make.treeqsm(make.y_model()), "oak.mat", ImportRequest(min_radius_mm=5))
    assert tree.species == "oak"
    assert tree.report["qsm"]["cylinders"] == 7
    assert glb[:4] == b"glTF"
    with pytest.raises(MeshError) as caught:
        import_mesh_sandboxed(damaged(), "oak.mat")
    assert caught.value.code == "unreadable"


@pytest.mark.parametrize("axis", ["x", "y", "-x", "-y", "-z"])
def test_another_axis_may_point_up(axis: Axis) -> None:
    """The same tree with its coordinates in another order is the same tree."""
    order = {"x": [2, 0, 1], "y": [1, 2, 0], "z": [0, 1, 2]}[axis[-1]]
    signs = [1.0, -1.0, -1.0] if axis.startswith("-") else [1.0, 1.0, 1.0]  # half a turn about x
    model = make.y_model()
    given = replace(model, start_m=(model.start_m * signs)[:, order], end_m=(model.end_m * signs)[:, order])
    found = read_tree(make.archi(given), "a.csv", ImportRequest(up_axis=axis))
    assert found.report["qsm"] == read_tree(make.archi(model), "a.csv").report["qsm"]
    assert found.wood_vertices_m[:, 1].max() == pytest.approx(4.0, abs=0.1)
    assert found.report["up_axis"]["value"] == axis


@pytest.mark.parametrize("factor", [100.0, 1000.0])
def test_a_given_height_replaces_the_unit(factor: float) -> None:
    scaled = read_tree(make.archi(make.y_model().scaled(factor)), "a.csv", ImportRequest(height_m=4.0))
    assert scaled.report["qsm"]["dbh_cm"] == pytest.approx(18.0)


def test_a_given_diameter_replaces_the_unit_of_the_radii() -> None:
    data = changed(radius_m=1000 * make.y_model().radius_m)
    found = read_tree(data, "a.csv", ImportRequest(dbh_cm=18.0)).report["qsm"]
    assert found["wood_volume_m3"] == pytest.approx(float(make.y_model().volume_m3.sum()))


def test_what_is_unusual_comes_with_a_warning() -> None:
    level = replace(make.y_model(), start_m=make.y_model().start_m[:, [2, 1, 0]] + [0, 0, 2])
    level = replace(level, end_m=make.y_model().end_m[:, [2, 1, 0]] + [0, 0, 2])
    assert any("barely rises" in words for words in read_tree(make.archi(level), "a.csv").report["warnings"])
    swollen = read_tree(with_value("radius_m", 2, 0.5), "a.csv").report["warnings"]
    assert any("more than 3 times as thick" in words for words in swollen)
    assert not any("thick as" in words for words in read_tree(changed(), "a.csv").report["warnings"])


def test_options_out_of_place_are_refused() -> None:
    low = make.archi(make.pole(length_m=1.0))
    with pytest.raises(MeshError) as caught:
        read_tree(low, "a.csv", ImportRequest(dbh_cm=5.0))
    assert caught.value.code == "no-breast-height"
