"""User-defined wood: accepted documents, rejected documents and their messages."""

import json

import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.solid.fem.model import FemSettings
from galewood.solid.model.construction import build_model
from galewood.wood.document import WoodDocument, WoodError, read_wood_document
from galewood.wood.species import wood_of_species


def test_omitted_fields_come_from_the_base_species():
    text = json.dumps({"name": "my oak", "based_on": "maple", "density_kg_m3": 1000.0})
    wood = read_wood_document(text).wood()
    assert (wood.name, wood.density_kg_m3) == ("my oak", 1000.0)
    assert wood.young_longitudinal_pa == wood_of_species("maple").young_longitudinal_pa
    assert wood.source == "the user"


@pytest.mark.parametrize(
    ("field", "value", "word"),
    [
        ("young_longitudinal_pa", -1.0, "greater"),
        ("young_longitudinal_pa", 7.0, "greater"),
        ("density_kg_m3", 1e9, "less"),
        ("damping_ratio", "much", "number"),
        ("streamlined_exponent", 0.9, "greater"),
        ("radial_ratio", True, "number"),
        ("stiffness", 1.0, "Extra"),
        ("name", "", "character"),
    ],
)
def test_error_names_the_invalid_field(field, value, word):
    with pytest.raises(WoodError, match=word) as caught:
        read_wood_document(json.dumps({"name": "x", field: value})).wood()
    assert [name for name, _ in caught.value.problems] == [field]


def test_error_names_all_invalid_fields():
    with pytest.raises(WoodError) as caught:
        read_wood_document('{"name": "x", "density_kg_m3": 1.0, "drag_coefficient": 9.0}').wood()
    assert {name for name, _ in caught.value.problems} == {"density_kg_m3", "drag_coefficient"}


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("not json", "JSON"),
        ("[]", "object"),
        ('{"name": "x", "density_kg_m3": NaN}', "finite"),
        ('{"name": "x", "based_on": "triffid"}', "apricot"),
        ('{"name": "x", "poisson_transverse": 0.95, "poisson_longitudinal": 0.6}', "unstable"),
    ],
)
def test_invalid_documents_are_rejected_with_a_reason(text, word):
    with pytest.raises(WoodError, match=word):
        read_wood_document(text).wood()


def test_schema_has_ranges_and_units():
    properties = WoodDocument.model_json_schema()["properties"]
    assert properties["density_kg_m3"]["anyOf"][0]["maximum"] == 1500
    assert "kg/m³" in properties["density_kg_m3"]["description"]


def test_stiffer_wood_has_higher_frequencies():
    bar = polygon_bar(sides=5, radius_m=0.05, length_m=3.0, layers=10)
    settings = FemSettings(element="quadratic", gravity=False)
    texts = [json.dumps({"name": "w", "young_longitudinal_pa": e}) for e in (5e9, 2e10)]
    soft, stiff = (build_model(bar, bar, read_wood_document(text).wood(), bar, settings) for text in texts)
    ratio = stiff.report["frequencies_hz"][0] / soft.report["frequencies_hz"][0]
    assert ratio == pytest.approx(2.0, rel=1e-3)
    assert stiff.report["wood_constants"]["young_longitudinal_pa"] == 2e10
