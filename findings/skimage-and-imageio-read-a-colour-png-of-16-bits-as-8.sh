#!/usr/bin/env bash
# Expected: a PNG of 16 bits is read as uint16, in colour as in grey.
# What happens: in grey it is uint16; in colour, and in grey beside a mask (alpha), pillow, and with it imageio and
#   scikit-image, return uint8, the upper eight bits: a ramp of 0 to 255 in 65535 is black all over, and one of the
#   whole range has 256 steps. Nothing says so; the mode is RGB or LA as of any other image.
# Package: pillow 13.0.0, imageio 2.38.1, scikit-image 0.26.0, opencv-python-headless 5.0.0.93. Source: found by trying.
# Who is hurt: whoever measures light, shade or depth in the colour images of a camera of 10 to 16 bits.
# Instead: cv2.imread(name, cv2.IMREAD_UNCHANGED), colours as blue, green, red (tried); its default is 8 bits, too.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pillow==13.0.0 imageio==2.38.1 scikit-image==0.26.0 opencv-python-headless==5.0.0.93
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import struct
import warnings
import zlib
from importlib.metadata import version

import cv2
import imageio.v3 as iio
import numpy as np
import skimage.io
from PIL import Image

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pillow", "imageio", "scikit-image", "opencv-python-headless")))


def png(name, pixels):
    """A PNG of 16 bits by its parts: header, one stream of rows without a filter, end."""
    rows, columns, bands = pixels.shape

    def part(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    colour = {1: 0, 2: 4, 3: 2, 4: 6}[bands]
    lines = b"".join(b"\0" + row.astype(">u2").tobytes() for row in pixels)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 16, colour, 0, 0, 0)))
        file.write(part(b"IDAT", zlib.compress(lines)) + part(b"IEND", b""))


readers = {
    "pillow": lambda name: np.asarray(Image.open(name)),
    "imageio": iio.imread,
    "scikit-image": skimage.io.imread,
    "opencv": lambda name: cv2.imread(name, cv2.IMREAD_UNCHANGED),
}
for kind, bands in (("grey", 1), ("grey and mask", 2), ("colour", 3), ("colour and mask", 4)):
    for top in (256, 65536):
        ramp = np.linspace(0, top - 1, 256 * 4).astype(np.uint16)
        pixels = np.repeat(ramp.reshape(16, 64, 1), bands, axis=2)
        png("image.png", pixels)
        for name, read in readers.items():
            found = read("image.png")
            steps = len(np.unique(found[..., 0] if found.ndim == 3 else found))
            print(f"{kind}, ramp to {top - 1}, {name}: {found.dtype}, {steps} steps for {len(np.unique(ramp))}")
            cut = bands > 1 and name != "opencv"
            assert found.dtype == (np.uint8 if cut else np.uint16)
            assert steps == ({256: 1, 65536: 256}[top] if cut else len(np.unique(ramp)))
PROGRAM
