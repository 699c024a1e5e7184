"""Files that are nested too deep, or in a circle, say so instead of crashing the process that reads them."""

from collections.abc import Callable

import pytest
from galewood.tree.importer import read_tree
from galewood.tree.sandboxed import import_mesh_sandboxed
from galewood.util import MeshError

from tests.precompute.fixtures import nested_files as nested

LEVELS = 50_000
CYCLE = [(5, 0), (6, 5), (5, 6)]
CHAIN = [(5, 0), *((k + 1, k) for k in range(5, 5000))]
DOUBLED = [(5, 0), *((k + 1, k) for k in range(5, 60)), *((k + 1, k) for k in range(5, 60))]
CASES: dict[str, Callable[[], bytes]] = {
    "text FBX": lambda: nested.deep_text_fbx(LEVELS),
    "binary FBX": lambda: nested.deep_binary_fbx(LEVELS),
    "FBX, models in a circle": lambda: nested.model_fbx(CYCLE),
    "FBX, a circle behind comments": lambda: nested.model_fbx(CYCLE, hidden=True),
    "FBX, a model of itself": lambda: nested.model_fbx([(5, 0), (5, 5)]),
    "FBX, a chain of models": lambda: nested.model_fbx(CHAIN),
    "FBX, models doubled 55 times": lambda: nested.model_fbx(DOUBLED),
    "binary FBX, models in a circle": nested.circular_binary_fbx,
    "DAE, by ids": nested.cyclic_dae,
    "DAE, by names": lambda: nested.cyclic_dae("name"),
    "DAE, a node within itself": nested.self_containing_dae,
    "DAE, a scene within itself": nested.scene_within_itself_dae,
    "DAE, nodes doubled 40 times": lambda: nested.doubling_dae(40),
    "DAE, elements": lambda: nested.deep_dae(LEVELS, "extra"),
    "DAE, nodes": lambda: nested.deep_dae(LEVELS),
    "DAE, parameters in a circle": nested.circular_parameters_dae,
    "3DS": lambda: nested.deep_3ds(LEVELS),
    "MAT, cells": lambda: nested.mat(nested.nested_cells(LEVELS)),
    "MAT, cells of wrong size": lambda: nested.mat(nested.nested_cells(LEVELS, honest=False)),
    "MAT, structs": lambda: nested.mat(nested.nested_cells(LEVELS, array_class=2)),
    "MAT, functions": lambda: nested.mat(nested.nested_cells(LEVELS, array_class=16)),
    "MAT, packed": lambda: nested.mat(nested.packed(nested.nested_cells(LEVELS))),
}


@pytest.mark.parametrize("data_of", CASES.values(), ids=CASES.keys())
def test_what_is_nested_too_deep_is_refused_before_it_is_parsed(data_of):
    with pytest.raises(MeshError) as caught:
        read_tree(data_of(), "a.bin")
    assert (caught.value.reason, caught.value.code) == ("unsuitable", "nested-too-deep")
    assert caught.value.hint


@pytest.mark.parametrize(
    ("data_of", "code"),
    [
        (lambda: nested.deep_text_fbx(250), ""),
        (lambda: nested.model_fbx([(5, 0), *((k + 1, k) for k in range(5, 250))]), ""),
        (lambda: nested.deep_dae(200), "no-volume"),
        (lambda: nested.doubling_dae(14), "no-volume"),
        (lambda: nested.deep_3ds(3_900), "no-volume"),
        (lambda: nested.mat(nested.packed(nested.nested_cells(60))), "no-cylinders"),
    ],
    ids=["FBX", "FBX models", "DAE", "DAE instances", "3DS", "MAT"],
)
def test_what_is_almost_too_deep_is_read(data_of, code):
    """In a child process, which would overflow its stack if the limits were too high."""
    try:
        import_mesh_sandboxed(data_of(), "a.bin")
    except MeshError as error:
        assert error.code == code, error.title
    else:
        assert code == ""
