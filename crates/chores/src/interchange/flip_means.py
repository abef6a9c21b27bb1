"""Prints the mean of FLIP of every pair of pictures of one size, as a list in JSON.

Arguments: files. The first of a pair is the reference; the order is that of the arguments, the reference slowest.
"""

import json
import struct
import sys

import flip_evaluator


def size(path):
    """Width and height from the header of a PNG file."""
    with open(path, "rb") as file:
        return struct.unpack(">II", file.read(24)[16:])


files = sys.argv[1:]
means = []
for reference in files:
    for test in files:
        if size(reference) == size(test):
            _, mean, _ = flip_evaluator.evaluate(reference, test, "LDR", applyMagma=False)
            means.append(float(mean))
print(json.dumps(means))
