"""A film that loops, of frames (PNG): `film.py FOLDER OUT.webp FPS FADED`.

The last FADED frames fade into the first.
"""

import sys
from pathlib import Path

from PIL import Image

WEBP_QUALITY = 62


def looped(frames: list[Image.Image], faded: int) -> list[Image.Image]:
    """The frames without their last `faded`, which the first ones begin as."""
    kept = len(frames) - faded
    start = [Image.blend(frames[kept + k], frames[k], (k + 1) / (faded + 1)) for k in range(faded)]
    return start + frames[faded:kept]


def main() -> None:
    """Writes the film; its name tells its coding (WebP)."""
    folder, out, fps, faded = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    frames = [Image.open(path).convert("RGB") for path in sorted(folder.glob("*.png"))]
    first, *others = looped(frames, faded)
    first.save(
        out,
        save_all=True,
        append_images=others,
        duration=round(1000 / fps),
        loop=0,
        quality=WEBP_QUALITY,
        method=4,
    )


if __name__ == "__main__":
    main()
