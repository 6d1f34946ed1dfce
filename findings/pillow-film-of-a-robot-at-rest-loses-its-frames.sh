#!/usr/bin/env bash
# Expected: twenty frames saved as GIF, APNG or WebP are twenty frames when they are read; their times are kept.
# What happens: a frame that equals the one before is dropped and its time added to that one: of a robot that moves in
#   four of twenty frames five are left, for Pillow and imageio. GIF also cuts times to 10 ms: 16.7 ms become 10.
# Packages: pillow 13.0.0, imageio 2.37.3. Source: found by trying; for GIF the merging is in Pillow's code alone.
# Who is hurt: whoever tracks a film in one of these formats by its frames' numbers.
# Instead: TIFF, or place each frame of an APNG by the sum of the durations before it (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pillow==13.0.0 imageio==2.38.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import imageio.v3 as iio
import numpy as np
import PIL
from PIL import Image

warnings.simplefilter("error")
RATE = 60.0
places = [5 + min(max(0, k - 5), 4) for k in range(20)]


def frame(x):
    image = np.full((40, 60), 90, np.uint8)
    image[15:20, x : x + 5] = 230
    return image


frames = [Image.fromarray(frame(x)) for x in places]
print("pillow", PIL.__version__, "imageio", version("imageio"), "numpy", np.__version__)
for name in ("film.gif", "film.png", "film.webp", "film.tif"):
    frames[0].save(name, save_all=True, append_images=frames[1:], duration=1000.0 / RATE)
    with Image.open(name) as film:
        durations, tops = [], []
        for k in range(film.n_frames):
            film.seek(k)
            film.load()
            durations.append(film.info.get("duration"))
            tops.append(int(np.asarray(film.convert("L"))[17].argmax()))
    seen = 20 if name == "film.tif" else len(list(iio.imiter(name)))
    print(f"{name}: {len(durations)} of 20 frames (imageio {seen}), durations {durations[:5]} ms")
    if name == "film.tif":
        assert len(durations) == 20
        continue
    assert len(durations) == seen == 5
    if name == "film.gif":
        assert durations[1] == 10 and sum(durations) < 0.95 * 20 * 1000.0 / RATE
    if name == "film.png":
        # instead
        starts = np.concatenate([[0.0], np.cumsum(durations)[:-1]])
        at = np.searchsorted(starts, 1000.0 * np.arange(20) / RATE + 1e-6) - 1
        assert [tops[k] for k in at] == places
PROGRAM
