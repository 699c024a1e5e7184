"""Write the golden inventories: ``python -m tests.golden.make_inventory``.

Files of stems with the trees and the report that Python reads from each, or the error; and the built-in tree
for every known name.
"""

# ruff: noqa: E501 (rows of files)
from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from galewood.inventory import InventoryError, match_species, read_inventory
from galewood.inventory.species import COMMON, STANDS_FOR

from tests.golden.texts import refused, write_golden

HERE = Path(__file__).parent
POINTS = (
    (8.40371, 49.00937, "Winterlinde", 21.5, 48),
    (8.40395, 49.00951, "Acer campestre 'Elsrijk'", 9.0, 22),
    (8.40418, 49.00922, None, 6.0, None),
    (8.40402, 49.00929, "Pyramidenpappel", None, 61),
)


def geojson(crs: str = "") -> str:
    """Points of a street."""
    features: list[dict[str, Any]] = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
            "properties": {"art": name, "baumhoehe": height, "stammdurchmesser": dbh, "x": 1},
        }
        for lon, lat, name, height, dbh in POINTS
    ]
    features.append({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": []}, "properties": {}})
    features.append({"type": "Feature", "geometry": None, "properties": {"art": "Ulme", "baumhoehe": 12}})
    reference = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    return json.dumps({"type": "FeatureCollection", **reference, "features": features}, ensure_ascii=False)


FILES: dict[str, str] = {
    "plain": "x,y,species,height,dbh\n0,0,maple,12,30\n10,5,poplar,22.5,28\n-4,8,Apricot,4,9\n",
    "german": "Baumart;Rechtswert;Hochwert;Höhe (m);BHD (cm)\nStieleiche;3500000,5;5400000;18,5;35\n"
    "Bergahorn;3500010;5400020;12;15\nZitterpappel;3500015;5400008;25;\nXyz;3500012;5400009;;40\nfoo;a;b;1;1\n",
    "units": "tree\tEast (ft)\tNorth (ft)\tHeight (ft)\tGirth (in)\nRed oak\t0\t0\t60\t55\nCrab apple\t30\t12\t18\t20\n",
    "millimetres": "# plot 7\ngenus,species,X,Y,h,d\nPicea,abies,1,1,24,310\nPinus,sylvestris,4,9,22,290\n,,9,3,7,\n",
    "metres": "x,y,ht,d\n1,1,24,0.31\n5,2,18,0.22\n2,8,11,\n",
    "degrees": "id;lat;lon;Art;Höhe;Umfang\n1;47,37;8,55;Roßkastanie;14;157\n2;47,3702;8,5503;Hain-Buche;9;88\n"
    "3;47,3699;8,5501;Prunus × yedoensis;6;60\n4;97;8,5;Ulme;9;88\n",
    "faults": 'x,y,species,height,dbh\n0,0,"maple, red",12,30\n,3,oak,9,9\n1,1,oak,,\n2,2,oak,400,10\n3,3,oak,10,2000\n'
    "5,5,oak,NA,25\n5000,5,ash,9,12\n6,1\n7,2,elm,tall,3\n",
    "geojson": geojson(),
    "geojson-metres": geojson("urn:ogc:def:crs:EPSG::25832"),
    "date-line": "lon,lat,height\n179.9995,-16.5,8\n-179.9995,-16.5,9\n",
}
BAD: dict[str, str] = {
    "scattered": "x,y,height\n0,0,9\n3000,0,9\n",
    "empty": "",
    "anemometer": "time,speed,direction\n0,3,240\n",
    "no-height": "x,y,species\n0,0,oak\n",
    "no-tree": "x,y,height\n0,,3\n",
    "no-rows": "x,y,height\n",
    "broken": '{"type": "FeatureCollection", ',
    "no-collection": '{"type": "Point", "coordinates": [8, 49]}',
    "no-feature": '{"type": "FeatureCollection", "features": [{"properties": {"height": 3}}]}',
}


def read(name: str, text: str) -> dict[str, Any]:
    """What Python reads from a file."""
    found = read_inventory(text.encode())
    stems = [asdict(stem) for stem in found.stems]
    return {"name": name, "text": text, "stems": stems, "report": found.report.document()}


def main() -> None:
    """Write the file."""
    golden = {
        "files": [read(name, text) for name, text in FILES.items()],
        "refused": [refused(name, text, read_inventory, InventoryError) for name, text in BAD.items()],
        "species": {name: asdict(match_species(name, 10.0)) for name in (*STANDS_FOR, *COMMON)},
    }
    write_golden(HERE / "inventory.json", golden)


if __name__ == "__main__":
    main()
