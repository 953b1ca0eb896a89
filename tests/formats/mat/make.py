#!/usr/bin/env python3
"""Writes the .mat files of this folder: by SciPy 1.10.1 and by Octave 7.3.0 (Debian 12).

    python3 make.py && octave --quiet make.m
"""
import numpy as np
import scipy.io

DOFS = np.array(["101:+Z", "7:-X", "m1"], dtype=object).reshape(-1, 1)
FREQUENCIES = np.array([[10.5, 20.25], [10.75, np.nan]])
SHAPES = np.arange(12.0).reshape(3, 2, 2, order="F") / 8

for name, compressed in (("scipy-v5.mat", False), ("scipy-v7.mat", True)):
    scipy.io.savemat(name, {"frequencies": FREQUENCIES, "shapes": SHAPES, "dofs": DOFS, "note": "a text",
                            "nested": {"left": "out"}, "counts": np.array([[1, 2]], dtype=np.int32)},
                     do_compression=compressed)
