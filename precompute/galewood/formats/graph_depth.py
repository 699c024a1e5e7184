"""What a hierarchy whose objects may be shared becomes once every object is copied to each of its places."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

MAX_DEPTH = 256
MAX_COPIES = 100_000


def problem_of(below: Sequence[Sequence[int]], roots: Iterable[int] | None = None) -> str | None:
    """The end of a sentence that says why objects cannot be expanded; None if they can.

    `below` lists what each object contains; only objects below `roots` count, if these are given. The cost is
    linear: each object is counted once.
    """
    size, height = [0] * len(below), [0] * len(below)  # 0: not known yet
    is_open = bytearray(len(below))
    for root in range(len(below)) if roots is None else roots:
        stack = [root]
        while stack:
            at = stack[-1]
            if size[at]:
                stack.pop()
            elif not is_open[at]:
                is_open[at] = 1
                unknown = [inner for inner in below[at] if not size[inner]]
                if any(is_open[inner] for inner in unknown):
                    return "form a cycle"
                stack += unknown
            else:
                size[at] = 1 + sum(size[inner] for inner in below[at])
                height[at] = 1 + max((height[inner] for inner in below[at]), default=0)
                if height[at] > MAX_DEPTH:
                    return f"are nested deeper than {MAX_DEPTH} levels"
                if size[at] > MAX_COPIES:
                    return f"are drawn more than {MAX_COPIES} times"
                stack.pop()
    return None
