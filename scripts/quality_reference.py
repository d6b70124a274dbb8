#!/usr/bin/env python3
"""Writes tests/quality_reference.json: discrepancies of fixed point sets by SciPy.

    python3 -m venv build/venv && build/venv/bin/pip install numpy scipy
    build/venv/bin/python scripts/quality_reference.py

Points are integers / 2^20 of a linear congruential generator, so that any program can make them exactly:
s <- 6364136223846793005 s + 1442695040888963407 mod 2^64, coordinate (s >> 44) / 2^20, point by point.
Two sets per dimension, and one whose coordinates are multiples of 1/8, with ties, zeros and repeated points.
"""
import json
import pathlib
import sys

import numpy
import scipy
from scipy.stats import qmc

SETS = [(n, d, 44) for d in (1, 2, 3, 5, 8) for n in (7, 256)] + [(40, d, 61) for d in (1, 2, 3, 5, 8)]


def points(n, d, seed, shift):
    state, rows = seed, []
    for _ in range(n):
        row = []
        for _ in range(d):
            state = (6364136223846793005 * state + 1442695040888963407) % 2**64
            row.append((state >> shift) / 2 ** (64 - shift))
        rows.append(row)
    return numpy.array(rows)


def main():
    methods = {"cd2": "CD", "wd2": "WD", "md2": "MD", "l2star": "L2-star"}
    sets = []
    for index, (n, d, shift) in enumerate(SETS):
        x = points(n, d, index + 1, shift)
        entry = {"n": n, "d": d, "seed": index + 1, "shift": shift, "last": x[-1].tolist()}
        entry |= {name: float(qmc.discrepancy(x, method=method)) for name, method in methods.items()}
        sets.append(entry)
    result = {
        "command": "scripts/quality_reference.py",
        "python": sys.version.split()[0],
        "numpy": numpy.__version__,
        "scipy": scipy.__version__,
        "convention": "scipy.stats.qmc.discrepancy: cd2, wd2, md2 are squared, l2star is the root",
        "sets": sets,
    }
    path = pathlib.Path(__file__).resolve().parent.parent / "tests" / "quality_reference.json"
    path.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
