"""Text from files: what is stored can be encoded, and what is shown cannot pretend to be something else."""

import json
import unicodedata

import numpy as np
import pytest
from galewood.measurements import read_measurement
from galewood.measurements.inventory import read_inventory
from galewood.util import MeshError, decoded, rows_of, shown_text

UNFIT = {"Cc", "Cf", "Cs", "Zl", "Zp"}


def random_texts(seed: int, count: int) -> list[str]:
    """Texts of characters from the whole of Unicode, half of them from the ranges that make trouble."""
    random = np.random.default_rng(seed)
    trouble = [*range(0xA0), *range(0xD7F0, 0xE010), *range(0x2000, 0x2070), *range(0xFFF0, 0x10000), 0x3164]
    texts: list[str] = []
    for _ in range(count):
        length = int(random.integers(0, 300))
        wild = random.integers(0, 0x110000, length)
        known = np.array(trouble)[random.integers(0, len(trouble), length)]
        texts.append("".join(map(chr, np.where(random.random(length) < 0.5, wild, known).tolist())))
    return texts


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        ("Stammholz (Ä) 木", "Stammholz (Ä) 木"),
        ("oak\ud800", "oak<U+D800>"),
        ("a\0b\x1b[31m\x85", "a<U+0000>b<U+001B>[31m<U+0085>"),
        ("two\r\nlines\tand more", "two  lines and more"),
        ("bark\u202egnp.exe\u2066", "bark<U+202E>gnp.exe<U+2066>"),
        ("wo\u200bod\ufeff\u2028", "wo<U+200B>od<U+FEFF><U+2028>"),
        ("blank\u3164", "blank<U+3164>"),
        ("", ""),
    ],
)
def test_unfit_characters_become_their_codes(raw, shown):
    assert shown_text(raw) == shown


@pytest.mark.parametrize("seed", range(3))
def test_any_text_can_be_encoded_and_cleaning_it_again_changes_nothing(seed):
    for raw in random_texts(seed, 300):
        shown = shown_text(raw)
        assert len(shown) <= 200
        assert not UNFIT & {unicodedata.category(char) for char in shown}, f"seed {seed}: {raw!r}"
        assert json.loads(json.dumps(shown, ensure_ascii=False).encode()) == shown
        assert shown_text(shown) == shown


def test_long_texts_with_the_same_beginning_stay_different():
    first, second = (shown_text("n" * 5000 + end) for end in "ab")
    assert first != second
    assert len(first) == len(second) == 200


def test_an_error_that_quotes_a_file_can_be_encoded():
    error = MeshError("code", "malformed", "The part \ud800\n" + 9000 * "x", "Rename \u202eit.")
    assert len(error.title) < 5000
    assert f"{error.title} {error.hint} {error}".encode()
    assert error.hint == "Rename <U+202E>it."


def test_cells_of_tables_are_clean():
    rows = list(rows_of(decoded("time;sp\u202eeed\x07\n1;2\n".encode())))
    assert rows[0].cells == ("time", "sp<U+202E>eed<U+0007>")


def all_texts(value: object) -> str:
    """All the text of a report, as it is sent."""
    return json.dumps(value, ensure_ascii=False)


@pytest.mark.parametrize("name", ["ei\ud800che", "ei\u202eche", "ei\u200bche\0", "e" * 100_000])
def test_inventories_and_measurements_with_nasty_names_can_be_sent(name):
    table = f"x;y;height (m);species {name} (m);species\n0;0;9;a;{name}\n3;4;9;a;{name}\n"
    feature = {
        "type": "Feature",
        "geometry": {"type": "Point", "coordinates": [11.5, 48.1]},
        "properties": {"species": name, f"height {name}": 1, "height": 9, name: name},
    }
    for data in (
        table.encode("utf-8", "surrogatepass"),
        json.dumps({"type": "FeatureCollection", "features": [feature] * 2}).encode(),
    ):
        inventory = read_inventory(data)
        stems = [stem.species for stem in inventory.stems]
        sent = all_texts([inventory.report.document(), stems])
        assert sent.encode() and len(sent) < 5000
        assert not UNFIT & {unicodedata.category(char) for text in stems for char in text}
    wind = f"time (s);speed {name} (m/s)\n" + "".join(f"{k};{5 + k % 3}\n" for k in range(40))
    sent = all_texts(read_measurement(wind.encode("utf-8", "surrogatepass")).report.document())
    assert sent.encode() and len(sent) < 5000
    assert not UNFIT & {unicodedata.category(char) for char in sent}


def test_errors_of_tables_quote_clean_text():
    for read, data in (
        (read_inventory, "x;y;height\nzero\u202e;0;9\n"),
        (read_measurement, "time (s);speed\u202e (m/s)\n0;1\n1;fast\u202e\x07\n"),
    ):
        with pytest.raises(ValueError, match="line") as caught:
            read(data.encode())
        assert not UNFIT & {unicodedata.category(char) for char in str(caught.value)}
