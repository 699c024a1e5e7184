"""Small cylinder models, and writers for the file format of each program."""

import io
from dataclasses import replace

import numpy as np
from galewood.formats.qsm.cylinders import Cylinders
from scipy.io import savemat

NONE = -1


def y_model() -> Cylinders:
    """A trunk of four cylinders of 1 m, a fork 2 m up with a limb of three; 4 m high, DBH 18 cm."""
    start = [[0, 0, 0], [0, 0, 1], [0, 0, 2], [0, 0, 3], [0, 0, 2], [0.6, 0, 2.8], [1.2, 0, 3.6]]
    end = [[0, 0, 1], [0, 0, 2], [0, 0, 3], [0, 0, 4], [0.6, 0, 2.8], [1.2, 0, 3.6], [1.5, 0, 4]]
    radius = np.array([0.1, 0.09, 0.07, 0.05, 0.05, 0.04, 0.03])
    parent = np.array([NONE, 0, 1, 2, 1, 4, 5])
    extension = np.array([1, 2, 3, NONE, 5, 6, NONE])
    return Cylinders(np.array(start, float), np.array(end, float), radius, parent, extension)


def pole(length_m=6.0, base_m=0.08, tip_m=0.04, count=40) -> Cylinders:
    """A straight pole whose radius decreases linearly, in equal cylinders with the radii of their middles."""
    height = np.linspace(0, length_m, count + 1)
    place = np.column_stack([np.zeros((count + 1, 2)), height])
    radius = base_m + (tip_m - base_m) * (np.arange(count) + 0.5) / count
    return chain(place, radius)


def chain(place, radius) -> Cylinders:
    """Cylinders one after the other through the places (k + 1, 3)."""
    count = len(radius)
    parent, extension = np.arange(-1, count - 1), np.append(np.arange(1, count), NONE)
    return Cylinders(place[:-1], place[1:], np.asarray(radius, float), parent, extension)


def random_model(seed: int, count: int = 400) -> Cylinders:
    """A tree that grows at random: any cylinder may be the next one's parent; noise and gaps."""
    random = np.random.default_rng(seed)
    start, end, radius, parent = [np.zeros(3)], [np.array([0.0, 0, 0.4])], [0.12], [NONE]
    for _ in range(count - 1):
        own = int(random.integers(max(0, len(end) - 60), len(end)))
        way = (end[own] - start[own]) / np.linalg.norm(end[own] - start[own])
        way = way + random.normal(size=3) * 0.5 + [0, 0, 0.2]
        start.append(end[own] + random.normal(size=3) * 0.01)
        end.append(start[-1] + way / np.linalg.norm(way) * random.uniform(0.001, 0.3))
        radius.append(max(0.004, radius[own] * random.uniform(0.75, 1.1)))
        parent.append(own)
    links = np.array(parent)
    return Cylinders(np.array(start), np.array(end), np.array(radius), links, np.full(count, NONE))


def beside(one: Cylinders, other: Cylinders) -> Cylinders:
    """Both models in one."""
    shift = len(one.radius_m)
    links = [np.where(rows >= 0, rows + shift, rows) for rows in (other.parent, other.extension)]
    return Cylinders(
        np.concatenate([one.start_m, other.start_m]),
        np.concatenate([one.end_m, other.end_m]),
        np.concatenate([one.radius_m, other.radius_m]),
        np.concatenate([one.parent, links[0]]),
        np.concatenate([one.extension, links[1]]),
    )


def moved(model: Cylinders, by) -> Cylinders:
    """The model elsewhere."""
    return replace(model, start_m=model.start_m + by, end_m=model.end_m + by)


def struct_of(model: Cylinders) -> dict[str, np.ndarray]:
    """Fields of a TreeQSM cylinder struct."""
    length = model.length_m
    return {
        "radius": model.radius_m[:, None].astype(np.float32),
        "length": length[:, None],
        "start": model.start_m,
        "axis": (model.end_m - model.start_m) / np.maximum(length, 1e-300)[:, None],
        "parent": (model.parent + 1)[:, None].astype(np.uint16),
        "extension": (model.extension + 1)[:, None].astype(np.uint16),
    }


def mat(variables) -> bytes:
    """A MATLAB file of version 5."""
    out = io.BytesIO()
    savemat(out, variables, do_compression=True)
    return out.getvalue()


def treeqsm(model: Cylinders, name="QSM") -> bytes:
    """A file of TreeQSM 2.3 and later."""
    return mat({name: {"cylinder": struct_of(model), "treedata": {"TotalVolume": 1.0}}})


def treeqsm_array(model: Cylinders) -> bytes:
    """A struct array of two models, as TreeQSM writes for several runs."""
    found = np.empty((1, 2), dtype=[("cylinder", object)])
    found[0, 0] = (struct_of(model),)
    found[0, 1] = (struct_of(pole()),)
    return mat({"QSM": found})


def treeqsm_matrix(model: Cylinders) -> bytes:
    """The columns of older exports."""
    columns = struct_of(model)
    return mat({"CylData": np.hstack([*columns.values(), np.zeros((len(model.radius_m), 5))])})


def treeqsm_matrix_in_struct(model: Cylinders) -> bytes:
    """The matrix as the field of a struct."""
    return mat({"QSM": {"cylinder": np.hstack(list(struct_of(model).values()))}})


def treeqsm_text(model: Cylinders) -> bytes:
    """The text file of TreeQSM 2.4: one name for the three columns of a point."""
    head = "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch"
    return "\n".join([head, *_matrix_lines(model, "\t", branch=True)]).encode()


def treeqsm_text_2_3(model: Cylinders) -> bytes:
    """The text file of TreeQSM 2.3, which has no names."""
    return "\n".join(_matrix_lines(model, "\t")).encode()


def matlab_table(model: Cylinders) -> bytes:
    """A table that was written by MATLAB, with blanks between the columns."""
    head = "Radius Length x_coord y_coord z_coord x_vector y_vector z_vector Parent_cyl Extension_cyl"
    return "\n".join([head, *_matrix_lines(model, "  ")]).encode()


def spreadsheet(model: Cylinders) -> bytes:
    """rTwig's columns as a spreadsheet saves them: its separator, a comment, UTF-16."""
    return f"sep=;\r\n# a comment\r\n{rtwig(model).decode()}".encode("utf-16")


def quoted(model: Cylinders) -> bytes:
    """Numbers with a decimal comma between quotation marks."""
    lines = rtwig(model, "\t").decode().splitlines()
    rows = [",".join(f'"{field}"' for field in line.replace(".", ",").split("\t")) for line in lines]
    return "\n".join(rows).encode()


def _matrix_lines(model: Cylinders, separator: str, branch: bool = False) -> list[str]:
    rows = np.hstack(list(struct_of(model).values()))
    if branch:
        rows = np.column_stack([rows, [1] * 4 + [2] * 3])
    return [separator.join(f"{value:.17g}" for value in row) for row in rows]


def treeqsm_old(model: Cylinders) -> bytes:
    """The separate variables of TreeQSM 2.0."""
    names = ("Rad", "Len", "Sta", "Axe", "CPar", "CExt")
    return mat(dict(zip(names, struct_of(model).values(), strict=True)))


def simpleforest(model: Cylinders) -> bytes:
    """Names with a leading blank, IDs from 0, −1 for the root's parent."""
    head = " ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, length"
    return _table(head, model, np.arange(len(model.parent)), model.parent, ",")


def archi(model: Cylinders) -> bytes:
    """IDs from 1, 0 for the root's parent."""
    head = "cyl_ID,parent_ID,startX,startY,startZ,endX,endY,endZ,radius_cyl,length"
    return _table(head, model, np.arange(len(model.parent)) + 1, model.parent + 1, ",")


def rtwig(model: Cylinders, separator=";") -> bytes:
    """Names of rTwig, with a decimal comma."""
    head = "id;parent;start_x;start_y;start_z;end_x;end_y;end_z;radius;length"
    content = _table(head, model, np.arange(len(model.parent)) + 1, model.parent + 1, ";").decode()
    return (content.replace(".", ",") if separator == ";" else content.replace(";", separator)).encode()


def _table(head, model, own, parent, separator) -> bytes:
    rows = np.column_stack([own, parent, model.start_m, model.end_m, model.radius_m, model.length_m])
    lines = [separator.join(f"{value:.17g}" for value in row) for row in rows]
    return "\n".join([head, *lines, ""]).encode()


WRITERS = {
    "struct.mat": treeqsm,
    "array.mat": treeqsm_array,
    "matrix.mat": treeqsm_matrix,
    "field.mat": treeqsm_matrix_in_struct,
    "old.mat": treeqsm_old,
    "cylinder.txt": treeqsm_text,
    "cyl_data.txt": treeqsm_text_2_3,
    "table.txt": matlab_table,
    "spreadsheet.csv": spreadsheet,
    "quoted.csv": quoted,
    "simpleforest.csv": simpleforest,
    "archi.csv": archi,
    "rtwig.csv": rtwig,
    "tabs.txt": lambda model: rtwig(model, "\t"),
}
