#!/usr/bin/env bash
# Expected: frame k of a film is its k-th frame, also where the camera paused (phones and webcams film at uneven
#   times).
# What happens: readers that are asked for a frame calculate a time from the mean or nominal rate. After a pause of 0.5
#   s frame 55 is 41 for imageio with pyav, 52 for OpenCV's CAP_PROP_POS_FRAMES, 39 for imageio with ffmpeg, which also
#   reads 80 frames for 60: it repeats the last one through the pause, a robot at rest. No warning.
# Package: av 18.1.0, imageio 2.38.1, imageio-ffmpeg 0.8.1, OpenCV 5.0.0. Source: found by trying.
# Who is hurt: whoever cuts, samples or tracks a film by the numbers of its frames.
# Instead: read one after the other with its times by PyAV or OpenCV, or constant_framerate=False (all tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pillow==13.0.0 av==18.1.0 imageio==2.38.1 imageio-ffmpeg==0.8.1 opencv-python-headless==5.0.0.93
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import fractions
import warnings
from importlib.metadata import version

import av
import cv2
import imageio
import imageio.v3 as iio
import numpy as np

warnings.simplefilter("error", UserWarning)
print(*(f"{name} {version(name)}" for name in ("av", "imageio", "imageio-ffmpeg", "opencv-python-headless", "numpy")))
count = 60
steps = np.full(count - 1, 1.0 / 30.0)
steps[19] += 0.5 - 1.0 / 30.0  # the camera waits before frame 20
steps[39] += 0.2
times = np.concatenate(([0.0], np.cumsum(steps)))


def picture(number):
    image = np.full((64, 96), 60, np.uint8)
    for bit in range(7):
        if number >> bit & 1:
            image[20:44, 10 + 10 * bit : 18 + 10 * bit] = 200
    return np.repeat(image[..., None], 3, axis=2)


def number(image):
    return sum(int(image[24:40, 12 + 10 * bit : 16 + 10 * bit].mean() > 130) << bit for bit in range(7))


with av.open("film.mp4", "w") as film:
    stream = film.add_stream("libx264", rate=30)
    stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
    stream.options = {"g": "12", "crf": "10"}
    stream.codec_context.time_base = fractions.Fraction(1, 30000)
    for k in range(count):
        frame = av.VideoFrame.from_ndarray(picture(k), format="rgb24")
        frame.pts, frame.time_base = round(times[k] * 30000), fractions.Fraction(1, 30000)
        film.mux(stream.encode(frame))
    film.mux(stream.encode())

with av.open("film.mp4") as film:
    read = [(number(frame.to_ndarray(format="rgb24")), frame.time) for frame in film.decode(video=0)]
assert [k for k, _ in read] == list(range(count)) and np.allclose([t for _, t in read], times, atol=1e-4)
by_ffmpeg = [number(image) for image in iio.imiter("film.mp4", plugin="FFMPEG")]
print(f"{count} frames at their times in the file; imageio by ffmpeg reads {len(by_ffmpeg)}, frame 19 "
      f"{by_ffmpeg.count(19)} times")
assert len(by_ffmpeg) == 80 and by_ffmpeg.count(19) == 14
seen = {}
for k in (10, 25, 45, 55):
    by_opencv = cv2.VideoCapture("film.mp4")
    by_opencv.set(cv2.CAP_PROP_POS_FRAMES, k)
    seen[k] = (number(iio.imread("film.mp4", index=k, plugin="pyav")),
               number(imageio.get_reader("film.mp4", "ffmpeg").get_data(k)), number(by_opencv.read()[1]))
    print(f"frame {k}: imageio by pyav {seen[k][0]}, by ffmpeg {seen[k][1]}, OpenCV {seen[k][2]}")
    # instead
    assert number(iio.imread("film.mp4", index=k, plugin="pyav", constant_framerate=False)) == k
assert seen == {10: (10, 10, 10), 25: (25, 19, 27), 45: (31, 21, 49), 55: (41, 39, 52)}
# read one after the other all is right in OpenCV and pyav
by_opencv = cv2.VideoCapture("film.mp4")
row = [(number(by_opencv.read()[1]), by_opencv.get(cv2.CAP_PROP_POS_MSEC) / 1e3) for _ in range(count)]
assert [k for k, _ in row] == list(range(count)) and np.allclose([t for _, t in row], times, atol=1e-4)
PROGRAM
