"""Writes docs/paper.md from the figures of a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from galewood.check.paper.pictures import PAPER_ELEMENTS, PAPER_FPS
from galewood.check.paper.plan import Plan

PAPER_FORESTS = {20: "100", 30: "80", 40: "70", 50: "its limit", 1000: "25 (in the abstract)"}
PAPER_HAUSDORFF = 0.011905
NAMES = {
    "modal": "modal model",
    "paper": "state search, eased",
    "paper-literal": "state search, literal",
    "paper-own-table": "state search, literal, six winds at 60° only",
}
Rows = Iterable[Sequence[str]]


def write_text(figures: dict[str, Any], plan: Plan, out: Path) -> None:
    """Write the page to ``out``; it shows the pictures in the folder of the same name beside it."""
    parts = (_head, _gusts, _winds, _gestures, _unseen, _elements, _directions, _forests, _memory, _search,
             _beyond, _short, _unchecked)  # fmt: skip
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text("\n\n".join(part(figures, out.stem) for part in parts) + "\n")


def table(head: Sequence[str], rows: Rows) -> str:
    """Return a Markdown table with the first column aligned left and all others right."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, rule, *rows))


def percent(value: float, digits: int = 2) -> str:
    """Format a fraction as per cent, without the sign."""
    return f"{100 * value:.{digits}f}"


def _head(figures: dict[str, Any], folder: str) -> str:
    trees, plan = figures["trees"], figures["plan"]
    rows = [
        [name, f"{s['height_m']:.1f}", f"{s['tetrahedra']:,}", f"{s['memory']['vertices']:,}",
         f"{s['memory']['records']:,}", str(s["modes"]), f"{s['design_speed_m_s']:.0f}"]
        for name, s in trees.items()
    ]  # fmt: skip
    head = ["tree", "height, m", "tetrahedra", "vertices", "records", "modes", "strongest sampled wind, m/s"]
    quick = "\n\n**This was a quick run: the figures are not results.**" if plan["quick"] else ""
    return f"""# The paper's experiments, repeated

*Real-time Physically Plausible Simulation of Forest* (Computers & Graphics, draft of February 2021)
evaluates its method on a maple, a poplar and an apricot. `galewood paper` repeats its experiments with the
built-in trees, of each species one grown in the open and one in a forest, and writes this page with its
pictures; no figure is entered by hand. Where the paper gives a figure, it stands beside ours. The paper
states neither its hardware nor the units of its errors, so its figures give orientation and are not a
benchmark.{quick}

{table(head, rows)}

A table holds the records of the paper, six cosine winds in six directions of {plan["record_frames"]} frames
each, and those of six decaying gusts. Three methods are compared with the reference solution of the
finite-element model that the table was built from:

- **modal model** (`modal`), the default: [0005](design/0005-drift-free-motion.md);
- **paper's state search, literal** (`paper-literal`): Algorithm 1 as printed, with the corrections that it
  needs to work (Eq. 13 counts mismatches, Eq. 12 has a lower bound);
- **paper's state search, eased** (`paper`): the same search, but the pose moves smoothly towards that of the
  record found ([0002](design/0002-pose-easing.md)), and in still air only records of still air are searched.

Errors are distances at the vertices of the wood, in per cent of the tree's height. HD is the symmetric
Hausdorff distance between the two sets of displaced vertices."""


def _gusts(figures: dict[str, Any], folder: str) -> str:
    plan, rows = figures["plan"], list[list[str]]()
    for name, found in figures["trees"].items():
        for wind, case in found["gusts"].items():
            modal, search = case["modal"], case.get("paper", {})
            rows.append([
                f"{name}, {wind}", f"{case['mean_speed_m_s']:.1f}", percent(case["reference_sway"], 1),
                percent(modal["rms_error_of_rms_sway"], 0), percent(modal["max_error"]),
                _number(modal["branches"]), percent(case["floor"]["rms_error_of_rms_sway"], 0),
                percent(search["rms_error_of_rms_sway"], 0) if search else "–",
            ])  # fmt: skip
    head = ["tree, wind", "mean speed, m/s", "sway", "modal, RMS of sway", "modal, largest",
            "modal, branches", "truncation, RMS of sway", "search, eased, RMS of sway"]  # fmt: skip
    return f"""## In gusts

The page and every forest play gusts that differ within a crown ([0020](design/0020-gusts.md)); the paper has
none. The reference solution feels the same gusts at each of its nodes. Winds of the preset "Autumn gusts",
{plan["frames"]} frames, seed {plan["seed"]}, two of them scaled to a sway. *Sway* and *largest* error: of any
vertex, in per cent of the height. *RMS of sway*: root mean square of the error of all nodes over that of
their sway about the mean pose, in per cent. *Branches*: motion of the outer half of the crown relative to the
trunk, over that of the reference solution; 1 is right. All sections below this one have winds that are the
same over the whole crown.

{table(head, rows)}"""


def _winds(figures: dict[str, Any], folder: str) -> str:
    return f"""## The six winds (Fig. 2)

![Pressure of the six cosine winds by frame]({folder}/winds.svg)

The paper shows its winds without numbers. The winds used here range from light air to the strongest sampled
wind but never reach zero: otherwise the search would find records of a tree that swings back in almost no
wind whenever the wind is light."""


def _gestures(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    for name, found in figures["trees"].items():
        fig = found["gestures"]
        first = str(fig["first_maximum_frame"])
        frames = ["20", "22", "40", "60", *([first] if first not in ("20", "22", "40", "60") else [])]
        head = [name, *(f"frame {f}" for f in frames)]
        rows = [
            [NAMES[method], *(percent(by_frame[f], 3) for f in frames)]
            for method, by_frame in fig["hausdorff"].items()
        ]
        rows.append(["*sway*", *(percent(fig["sway"][f]) if f in fig["sway"] else "" for f in frames)])
        blocks.append(table(head, rows))
        blocks.append(f"The {name} reaches its first maximum at frame {first}.")
        blocks.append(f"![Gestures of the {name}]({folder}/gestures-{name}.png)")
    return f"""## Gestures in an unseen wind (Fig. 3)

The tree starts from rest in a cosine wind at 60° whose amplitude and period no sampled wind has. The tables
give the HD in per cent of the height. The paper reports for its maple {PAPER_HAUSDORFF} at the first maximum
(frame 22), more at frame 40 and less again at frame 60, without stating the unit. As the paper samples a
single direction for this experiment, the literal search is also run on a table of the six winds at 60° only.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}

In the pictures the reference solution is drawn in grey behind the other two trees."""


def _unseen(figures: dict[str, Any], folder: str) -> str:
    plan, blocks = figures["plan"], []
    methods = ("modal", "paper", "paper-literal", "nearest-sample", "rest-pose")
    for name, found in figures["trees"].items():
        rows = [
            [wind, percent(by["rest-pose"]["reference_sway"], 1), percent(by["modal"]["max_error"], 3),
             percent(by["modal"]["rms_error"], 3), _number(by["modal"]["growth"]),
             *(percent(by[method]["max_error"], 1) for method in methods[1:]),
             percent(by["floor"]["truncation"], 3), percent(by["modal"]["rendered"]["max_error"], 2)]
            for wind, by in found["winds"].items()
        ]  # fmt: skip
        head = [name, "sway", "modal", "modal, RMS", "modal, growth", "search, eased", "search, literal",
                "nearest sample", "rest pose", "truncation", "modal, rendered"]  # fmt: skip
        blocks += [table(head, rows), f"![Error over time, {name}]({folder}/errors-{name}.png)"]
    return f"""## Twenty seconds of unseen, uniform winds

{plan["frames"]} frames of each wind, peaking at {plan["strength"]} of the strongest sampled speed, seed
{plan["seed"]}. The tables give the largest error of any vertex in any frame, in per cent of the height.
*Growth* is the largest error of the second half of the run over that of the first. For this, continuing winds
repeat after half a run and are preceded by one more pass from rest, so that both halves have the same wind.
*Truncation* is the error of the reduced basis alone; *rendered* is the error at the render vertices, several
of which share a node.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}"""


def _elements(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    paper: dict[int, int] = dict(zip(PAPER_ELEMENTS, PAPER_FPS, strict=True))
    for name, found in figures["trees"].items():
        rows = [
            [count, str(paper.get(int(count), "–")), _rate(row["exhaustive_us"]), _rate(row["paper_us"]),
             _rate(row["modal_us"]), f"{row['exhaustive_us']:,.0f}", f"{row['paper_us']:.2f}",
             f"{row['modal_us']:.2f}", f"{row['table_bytes'] / 1e6:.1f}"]
            for count, row in found["elements"].items()
        ]  # fmt: skip
        head = [f"{name}: elements", "paper, fps", "as printed, 1/s", "candidates, 1/s", "modal, 1/s",
                "as printed, µs", "candidates, µs", "modal, µs", "table, MB"]  # fmt: skip
        blocks.append(table(head, rows))
    records = max(row["records"] for s in figures["trees"].values() for row in s["elements"].values())
    return f"""## Sampled elements (Table 1)

Steps of one tree per second, and CPU time per step, on one thread (best of five repeats; the last two methods
in a forest of 1,000 trees). The times are measured in every run of `galewood paper`. As in the paper, the
tables hold the six winds in one direction (60°), {figures["plan"]["element_frames"]} frames each, {records:,}
records. *As printed* compares the whole state with every record at every step; this corresponds to the
paper's frame rates, which include drawing the tree.

{chr(10).join(f"{block}{chr(10)}" for block in blocks).rstrip()}

![Steps of one tree per second by number of sampled elements]({folder}/elements.svg)

The paper's frame rate falls by a factor of 2.3 from 35 to 435 elements. After the first step a tree's state
is always that of a record, so the states can be compared once, when the table is built
([0001](design/0001-exact-search.md)). The search then finds the same records at a cost that does not depend
on the number of elements."""


def _directions(figures: dict[str, Any], folder: str) -> str:
    blocks: list[str] = []
    for name, found in figures["trees"].items():
        rows = [
            [f"{direction}°", percent(row["sway"]), *(percent(row["hausdorff"][m], 3) for m in
             ("modal", "paper", "paper-literal"))]
            for direction, row in found["directions"].items()
        ]  # fmt: skip
        blocks.append(table([name, "sway", "modal, HD", "search, eased, HD", "search, literal, HD"], rows))
    first = next(iter(figures["trees"]))
    return f"""## Six directions of one wind (Fig. 5)

The strongest sampled wind from each of the six directions at frame 20, in per cent of the height. The same
wind bends the tree differently from each side. These winds are in the table, so the literal search only
follows their records.

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
    head = ["trees", "paper, fps", "wind, ms", "modal, ms", "search, eased, ms", "modal, steps/s",
            "search, eased, steps/s"]  # fmt: skip
    return f"""## Trees in real time

CPU time of one step on one thread, and the resulting steps per second, for forests with equal numbers of all
species under gusts of 1/f noise. The times are measured in every run of `galewood paper`. A step is a
thirtieth of a second, so 30 steps per second suffice. The paper's figures include drawing, and its 1,000
trees are copies of 50 simulated ones; here every tree is simulated.

{table(head, rows)}"""


def _memory(figures: dict[str, Any], folder: str) -> str:
    names = (
        ("full states and increments, dense K", "raw"),
        ("states of the sampled elements, dense K̃, increments of all vertices", "reduced"),
        ("the same with only the compared blocks of K̃", "reduced_blocks"),
        ("increments of all vertices only", "increments"),
        ("**the table file**", "table"),
    )
    trees = figures["trees"]
    rows = [[label, *(_bytes(s["memory"][key]) for s in trees.values())] for label, key in names]
    return f"""## Memory

Size of a table and of the paper's tuples (K, v, f_int, f_ext, Δu) in single precision.

{table(["", *trees], rows)}

The paper gives no sizes. The motion is low-rank, so the increment of a record takes some twenty numbers. The
states are not stored, only which records can follow which."""


def _search(figures: dict[str, Any], folder: str) -> str:
    rows = [
        [name, f"{s['search']['queries']:,}", f"{s['search']['states']:,}", str(s["search"]["differences"])]
        for name, s in figures["trees"].items()
    ]
    return f"""## The exact search

Trees step through the table under winds that jump at every step. Each query is answered from the table's
candidate lists and by Algorithm 1 as printed, which compares the state with every record
(seed {figures["plan"]["seed"]}).

{table(["tree", "queries", "distinct states", "differences"], rows)}"""


def _beyond(figures: dict[str, Any], folder: str) -> str:
    rows = [
        [name, f"{s['beyond']['times']:g} ×", percent(s["beyond"]["largest"], 0),
         f"{s['beyond']['extrapolation_ratio']:.2f}", f"{s['beyond']['left_at_rest_m']:.1g}"]
        for name, s in figures["trees"].items()
    ]  # fmt: skip
    head = ["tree", "pressure", "largest displacement, % of height", "extrapolation ratio", "left after, m"]
    return f"""## Beyond the sampled range

The modal model in a wind far stronger than any sampled one, which changes sign repeatedly, and then in still
air. The motion stays bounded, an extrapolation ratio above 1 reports that the wind is beyond the sampled
range, and the tree comes to rest.

{table(head, rows)}"""


def _short(figures: dict[str, Any], folder: str) -> str:
    worst, worse, runs = 0.0, 0, 0
    modal = 0.0
    for found in figures["trees"].values():
        for by in found["winds"].values():
            literal, rest = by["paper-literal"]["max_error"], by["rest-pose"]["max_error"]
            worst, worse, runs = max(worst, literal), worse + int(literal > rest), runs + 1
            modal = max(modal, by["modal"]["max_error"])
    far, own = percent(worst, 0), percent(modal)
    times = [row["exhaustive_us"] for s in figures["trees"].values() for row in s["elements"].values()]
    least, most = f"{min(times):,.0f}", f"{max(times):,.0f}"
    return f"""## Limitations of the paper's method

- **It drifts.** The pose is not part of the search key, and increments are summed without bound. "The
  simulation error does not always accumulate" holds for the 60 frames that the paper shows. Over
  {figures["plan"]["frames"]} frames the error of the literal search reaches {far} % of the height, and in
  {worse} of {runs} runs it exceeds that of a tree that does not move. The largest error of the modal model in
  the same runs is {own} %.
- **It repeats the comparison of states at every step.** Comparing the state with every record of a table of
  one direction takes between {least} and {most} µs per tree and step, depending on the number of sampled
  elements. The paper does not mention that this can be done before run time.
- **It does not work as printed.** Eq. 7 and 9 are inverted. Eq. 13 counts matches where Algorithm 1 seeks the
  minimum. Eq. 12 gives a component at rest a range of zero. The Gaussian of Eq. 16 is largest where the wind
  matches best. Line 14 of Algorithm 2 loses the displacement. The last record of a run has no successor.
- **Eq. 4 does not fit its own finite elements.** K(u) u turns a rotation into a force. Here the force of the
  corotational elements is used, and K is its tangent."""


def _unchecked(figures: dict[str, Any], folder: str) -> str:
    return """## What could not be checked

- The frame rates: the paper names no processor, graphics card or language, and its rates include drawing. The
  two halves of its Table 1 (poplar and maple) begin with the same figures.
- The Hausdorff distances: the paper gives neither unit, vertex set nor wind (Fig. 3a has no numbers).
- The meshes: the paper's 5,710 elements are hexahedra of unpublished trees; here they are tetrahedra of other
  trees.
- The weights, σ and "manipulating the weights specially": the paper gives no numbers. Those used here are in
  [0002](design/0002-pose-easing.md) and in the metadata of every table.
- The forests: the table of 20, 30 and 40 trees has no number, the pictures of 50 and of 500 trees are
  placeholders in the draft, and the frame rate of the forest of 500 trees is a question mark.
- That the motion looks "physically plausible": the paper reports no user study, and none was made here.
- That more sampled elements give more exact trajectories: the paper states this without figures, and it was
  not measured here.
- Domain decomposition (the paper's future work, Fig. 7)."""


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
