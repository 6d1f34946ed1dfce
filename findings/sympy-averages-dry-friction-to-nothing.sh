#!/usr/bin/env bash
# Expected: integrate and fourier_series of sign(sin(x)), the dry friction of a shaken block, are right or unevaluated:
#   over one half period sympy gives the right pi.
# What happens: the antiderivative is found for the first period only, 0 beyond it. So over 0 to 3 pi the integral is 0
#   instead of pi, and the Fourier series over -pi to pi has half of its amplitudes, without a word.
# Package: sympy 1.14.0. Source: found by trying.
# Who is hurt: whoever averages or linearises Coulomb friction, a square wave or a chopper.
# Instead: one period from 0, or the series of sign(x) over -pi to pi (tried); check by quad.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    sympy==1.14.0 mpmath==1.3.0 numpy==2.3.5 scipy==1.17.1
"$folder/venv/bin/python" - <<'PROGRAM'
import sympy
from scipy.integrate import quad
from sympy import cos, fourier_series, integrate, pi, sign, sin, symbols

x = symbols("x", real=True)
square = sign(sin(x))
assert integrate(square, (x, 0, pi)) == pi
assert integrate(square, (x, 0, 2 * pi)) == 0
assert integrate(sign(cos(x)) * cos(x), (x, 0, 2 * pi)) == 4
wrong = integrate(square, (x, 0, 3 * pi))
true, _ = quad(lambda t: float(sympy.sign(sympy.sin(t))), 0, 3 * float(pi), points=[3.14159265, 6.2831853])
assert wrong == 0 and abs(true - float(pi)) < 1e-4
antiderivative = integrate(square, x)
assert antiderivative.subs(x, 7) == 0 and antiderivative.subs(x, -1) == 0
series = fourier_series(square, (x, -pi, pi)).truncate(2)
assert sympy.simplify(series - 2 / pi * (sin(x) + sin(3 * x) / 3)) == 0
good = fourier_series(sign(x), (x, -pi, pi)).truncate(2)
assert sympy.simplify(good - 4 / pi * (sin(x) + sin(3 * x) / 3)) == 0
print("sympy", sympy.__version__)
print("integral over 0 to 3 pi:", wrong, "; by quadrature:", round(true, 4))
print("antiderivative:", antiderivative)
print("series of sign(sin(x)):", series, "; right:", good)
PROGRAM
