"""The words and tables of docs/paper.md, from the figures alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from galewood.paper.pictures import PAPER_ELEMENTS, PAPER_FPS
from galewood.paper.plan import SPECIES, Plan

PAPER_FORESTS = {20: "100", 30: "80", 40: "70", 50: "its limit", 1000: "25 (in the abstract)"}
PAPER_HAUSDORFF = 0.011905
NAMES = {
    "modal": "modal",
    "paper": "paper's search, eased",
    "paper-literal": "paper's search, literal",
    "paper-own-table": "literal, table of six winds at 60° only",
    "nearest-sample": "nearest sampled run played back",
    "rest-pose": "not moving at all",
}
Rows = Iterable[Sequence[str]]


def write_text(figures: dict[str, Any], plan: Plan, out: Path) -> None:
    """Write the document; pictures are expected in the folder of its name beside it."""
    parts = (_head, _winds, _gestures, _unseen, _elements, _directions, _forests, _memory, _search, _beyond,
             _short, _unchecked)  # fmt: skip
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n\n".join(part(figures, out.stem) for part in parts) + "\n")


def table(head: Sequence[str], rows: Rows) -> str:
    """A Markdown table, its first column to the left and all others to the right."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, rule, *rows))


def percent(value: float, digits: int = 2) -> str:
    """A share of the height as per cent."""
    return f"{100 * value:.{digits}f}"


def _head(figures: dict[str, Any], folder: str) -> str:
    species, plan = figures["species"], figures["plan"]
    rows = [
        [name, f"{s['height_m']:.1f}", f"{s['tetrahedra']:,}", f"{s['memory']['vertices']:,}",
         f"{s['memory']['records']:,}", str(s["modes"]), f"{s['design_speed_m_s']:.0f}"]
        for name, s in species.items()
    ]  # fmt: skip
    head = ["tree", "height, m", "tetrahedra", "vertices", "records", "modes", "strongest sampled wind, m/s"]
    missing = [name for name in SPECIES if name not in species]
    lacks = f" This run had the {' and the '.join(species)} alone." if missing else ""
    quick = "\n\n**A quick run: nothing here is a result.**" if plan["quick"] else ""
    return f"""# The paper's experiments, again

*Real-time Physically Plausible Simulation of Forest* (Computers & Graphics, draft of February 2021)
measures its method on a maple, a poplar and an apricot. `galewood paper` does every experiment again with
the three species of this repository and wrote this page and its pictures; nothing in it is typed by hand.
Beside each figure stands the paper's own. The paper names neither its machine nor the units of its
errors, so its figures are a landmark and not an opponent.{lacks}{quick}

{table(head, rows)}

A table holds what the paper's holds, six cosine winds in six directions of {plan["record_frames"]}
frames, and six gusts that die down. Three ways to play it are compared with the finite elements that it
was made from:

- **drift-free** (`tangent`), the default: [0005](design/0005-drift-free-motion.md);
- **paper's search, literal** (`paper-literal`): Algorithm 1 as it stands, with the readings that make it work
  (Eq. 13 counts mismatches, Eq. 12 has a floor);
- **paper's search, eased** (`paper`): the same search, the pose drawn gently to that of the record found
  ([0002](design/0002-pose-easing.md)), and records of still air for still air.

Errors are distances over the tree's height, in per cent, at the vertices of the wood. HD is the symmetric
Hausdorff distance between the two sets of displaced vertices."""


def _winds(figures: dict[str, Any], folder: str) -> str:
    return f"""## The six winds (Fig. 2)

![Pressure of the six cosine winds over the frames of a sample]({folder}/winds.svg)

The paper shows its winds without numbers. These span calm air to the strongest sampled wind and keep away
from zero: a record of little wind on a tree that swings back would be found in light winds."""


def _gestures(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    for name, found in figures["species"].items():
        fig = found["gestures"]
        first = str(fig["first_maximum_frame"])
        frames = ["20", "22", "40", "60", *([first] if first not in ("20", "22", "40", "60") else [])]
        head = [name, *(f"frame {f}" for f in frames)]
        rows = [
            [NAMES[method], *(percent(by_frame[f], 3) for f in frames)]
            for method, by_frame in fig["hausdorff"].items()
        ]
        rows.append(
            ["*sway of the tree*", *(percent(fig["sway"][f]) if f in fig["sway"] else "" for f in frames)]
        )
        blocks.append(table(head, rows))
        blocks.append(f"The {name} first turns back at frame {first}.")
        blocks.append(f"![Gestures of the {name}]({folder}/gestures-{name}.png)")
    return f"""## Gestures in a wind that was not sampled (Fig. 3)

A cosine wind at 60° of an amplitude and a period that no sample has, from rest. HD in per cent of the
height. The paper's maple: {PAPER_HAUSDORFF} at its first maximum (frame 22), larger at frame 40, smaller
again at frame 60; in which unit it does not say. As it samples one direction for this experiment, the
literal search is also given a table of the six winds at 60° alone.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}

In the pictures the tree as the finite elements have it stands in grey behind the other two."""


def _unseen(figures: dict[str, Any], folder: str) -> str:
    plan, blocks = figures["plan"], []
    methods = ("modal", "paper", "paper-literal", "nearest-sample", "rest-pose")
    for name, found in figures["species"].items():
        rows = [
            [wind, percent(by["rest-pose"]["reference_sway"], 1), percent(by["modal"]["max_error"], 3),
             percent(by["modal"]["rms_error"], 3), _number(by["modal"]["growth"]),
             *(percent(by[method]["max_error"], 1) for method in methods[1:]),
             percent(by["floor"]["truncation"], 3), percent(by["modal"]["rendered"]["max_error"], 2)]
            for wind, by in found["winds"].items()
        ]  # fmt: skip
        head = [name, "sway", "modal", "its RMS", "its growth", "eased", "literal", "nearest sample",
                "not moving", "modes alone", "drift-free as drawn"]  # fmt: skip
        blocks += [table(head, rows), f"![Errors over time, {name}]({folder}/errors-{name}.png)"]
    return f"""## Twenty seconds of winds that were not sampled

{plan["frames"]} frames of each wind, peaking at {plan["strength"]} of the strongest sampled speed, seed
{plan["seed"]}. Largest error of any vertex in any frame, per cent of the height. *Growth* is the largest
error of the second half over that of the first: winds that go on repeat every half run, after one more pass
as a lead-in from rest, so that both halves are alike. *Modes alone* is what the reduced basis leaves out even
if the method made no error; *as drawn* is at the render vertices, where several of them share a node.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}"""


def _elements(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    paper: dict[int, int] = dict(zip(PAPER_ELEMENTS, PAPER_FPS, strict=True))
    for name, found in figures["species"].items():
        rows = [
            [count, str(paper.get(int(count), "–")), _rate(row["exhaustive_us"]), _rate(row["paper_us"]),
             _rate(row["modal_us"]), f"{row['exhaustive_us']:,.0f}", f"{row['paper_us']:.2f}",
             f"{row['modal_us']:.2f}", f"{row['table_bytes'] / 1e6:.1f}"]
            for count, row in found["elements"].items()
        ]  # fmt: skip
        head = [f"{name}: elements", "paper, fps", "as printed, 1/s", "short lists, 1/s", "drift-free, 1/s",
                "as printed, µs", "short lists, µs", "drift-free, µs", "table, MB"]  # fmt: skip
        blocks.append(table(head, rows))
    records = max(row["records"] for s in figures["species"].values() for row in s["elements"].values())
    return f"""## Sampled elements (Table 1)

Steps of one tree a second, and the time of one, in one thread of a program that does nothing else
(processor time, best of five; the last two in a forest of 1,000 trees). As in the paper, the tables have the
six winds in one direction (60°) of {figures["plan"]["element_frames"]} frames each, {records:,} records.
*As printed*
compares the whole state with every record at every step, which is what the paper's frame rates must be
set beside; they include drawing the tree.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}

![Steps of one tree a second over the number of sampled elements]({folder}/elements.svg)

The paper slows 2.3 times from 35 to 435 elements. After the first step a tree's state is always a
record's, so the comparison can be made once, when the table is built
([0001](design/0001-exact-search.md)): the search then finds the same records at a cost that no longer
grows with the elements."""


def _directions(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    for name, found in figures["species"].items():
        rows = [
            [f"{direction}°", percent(row["sway"]), *(percent(row["hausdorff"][m], 3) for m in
             ("modal", "paper", "paper-literal"))]
            for direction, row in found["directions"].items()
        ]  # fmt: skip
        blocks.append(table([name, "sway", "drift-free, HD", "eased, HD", "literal, HD"], rows))
    first = next(iter(figures["species"]))
    return f"""## Six directions of one wind (Fig. 5)

The strongest sampled wind from each of the six directions, frame 20, per cent of the height. The same
wind bends the tree differently from each side. These winds are samples, so the literal search walks along
its own records.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}

![Gestures of the {first} at frame 20 in six directions]({folder}/directions-{first}.png)"""


def _forests(figures: dict[str, Any], folder: str) -> str:
    rows = [
        [f"{int(count):,}", PAPER_FORESTS.get(int(count), "–"), f"{row['wind_ms']:.3f}",
         f"{row['modal_ms']:.3f}", f"{row['paper_ms']:.3f}",
         f"{1e3 / (row['wind_ms'] + row['modal_ms']):,.0f}",
         f"{1e3 / (row['wind_ms'] + row['paper_ms']):,.0f}"]
        for count, row in figures["forests"].items()
    ]  # fmt: skip
    head = ["trees", "paper, fps", "wind, ms", "drift-free, ms", "eased search, ms", "drift-free, steps/s",
            "eased search, steps/s"]  # fmt: skip
    return f"""## Trees in real time

Every tree on its own, as many of each species, under gusts of 1/f noise: processor time of one step in
one thread, and the steps a second that leaves. A step is a thirtieth of a second, so 30 suffice. The
paper's figures include drawing; its 1,000 trees are 50 that are simulated and copies of them, where every
tree here moves on its own.

{table(head, rows)}"""


def _memory(figures: dict[str, Any], folder: str) -> str:
    names = (
        ("whole states and increments, K dense", "raw"),
        ("states of the sampled elements, K̃ dense, increments of all vertices", "reduced"),
        ("the same, of K̃ only the compared blocks", "reduced_blocks"),
        ("increments of all vertices alone", "increments"),
        ("**the table file**", "table"),
    )
    species = figures["species"]
    rows = [[label, *(_bytes(s["memory"][key]) for s in species.values())] for label, key in names]
    return f"""## Memory

A table beside what the paper's tuples (K, v, f_int, f_ext, Δu) would take in single precision.

{table(["", *species], rows)}

The paper gives no sizes. The motion is low-rank, so a record's increment is some twenty numbers; the
states are not stored at all, only which records can follow which."""


def _search(figures: dict[str, Any], folder: str) -> str:
    rows = [
        [name, f"{s['search']['queries']:,}", f"{s['search']['states']:,}", str(s["search"]["differences"])]
        for name, s in figures["species"].items()
    ]
    return f"""## The exact search

Trees walk the table under winds that jump at every step; each query goes to the table's short lists and to
Algorithm 1 as printed, which compares the state with every record (seed {figures["plan"]["seed"]}).

{table(["tree", "queries", "distinct states", "differences"], rows)}"""


def _beyond(figures: dict[str, Any], folder: str) -> str:
    rows = [
        [name, f"{s['beyond']['times']:g} ×", percent(s["beyond"]["largest"], 0),
         f"{s['beyond']['extrapolation_ratio']:.2f}", f"{s['beyond']['left_at_rest_m']:.1g}"]
        for name, s in figures["species"].items()
    ]  # fmt: skip
    head = ["tree", "pressure", "largest displacement, % of height", "extrapolation_ratio", "left after, m"]
    return f"""## Beyond the samples

The drift-free method under a wind far stronger than any sampled, back and forth, then in still air: it stays
bounded, says that it is beyond its samples (coverage above 1), and comes to rest.

{table(head, rows)}"""


def _short(figures: dict[str, Any], folder: str) -> str:
    worst, worse, runs = 0.0, 0, 0
    modal = 0.0
    for found in figures["species"].values():
        for by in found["winds"].values():
            literal, rest = by["paper-literal"]["max_error"], by["rest-pose"]["max_error"]
            worst, worse, runs = max(worst, literal), worse + int(literal > rest), runs + 1
            modal = max(modal, by["modal"]["max_error"])
    far, own = percent(worst, 0), percent(modal)
    times = [row["exhaustive_us"] for s in figures["species"].values() for row in s["elements"].values()]
    least, most = f"{min(times):,.0f}", f"{max(times):,.0f}"
    return f"""## Where the paper's own method falls short

- **It drifts.** The pose is not part of the key and increments are summed for ever. "The simulation error
  does not always accumulate" holds for the 60 frames that the paper shows; over
  {figures["plan"]["frames"]} frames the literal search strays up to {far} % of the height, and in {worse}
  of {runs} runs farther from the truth than a tree that does not move at all. The drift-free method's
  worst in the same runs is {own} %.
- **Its search is made again at every step.** Comparing the state with every record takes {least} µs of a
  tree and step with the fewest sampled elements and {most} µs with the most, for a table of one direction;
  that it need not be done at run time at all is not in the paper.
- **As printed it does not run.** Eq. 7 and 9 are upside down, Eq. 13 counts matches where Algorithm 1
  seeks the least, Eq. 12 gives a component at rest a range of zero, the Gaussian of Eq. 16 is largest where
  the wind matches best, line 14 of Algorithm 2 loses the displacement, and the last record of a run has no
  successor to go to.
- **Eq. 4 is not what its own finite elements need:** K(u) u turns a rotation into a force; the force of the
  corotational elements is used, and K is its tangent."""


def _unchecked(figures: dict[str, Any], folder: str) -> str:
    return """## What could not be checked

- The frame rates themselves: the paper names no processor, no graphics card and no language, and its
  rates include drawing. The two halves of its Table 1 (poplar and maple) begin with the same figures.
- Hausdorff distances against its own: unit, vertex set and wind (Fig. 3a has no numbers) are not given.
- Its meshes of 5,710 elements are hexahedra of trees that are not published; these are tetrahedra of
  other trees.
- Weights, σ and "manipulating the weights specially": no numbers are given. What is used here is in
  [0002](design/0002-pose-easing.md) and in every table's metadata.
- The table of 20, 30, 40 trees has no number, the pictures of 50 and of 500 trees are placeholders in the
  draft, and the rate of its forest of 500 trees is a question mark.
- That the motion is "physically plausible" to the eye: no study of viewers is reported, and none was made
  here.
- That more sampled elements make a trajectory more exact: stated without figures, and not measured here.
- Domain decomposition (its future work, Fig. 7)."""


def _rate(step_us: float) -> str:
    rate = 1e6 / step_us
    return f"{rate:,.0f}" if rate < 1e6 else f"{rate / 1e6:.2f} M"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


def _bytes(value: float) -> str:
    for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if value >= size:
            return f"{value / size:,.1f} {unit}"
    return f"{value / 1e3:,.0f} kB"
