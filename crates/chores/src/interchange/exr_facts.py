"""What an OpenEXR file says and holds, by the reader of OpenEXR's authors: one JSON object on standard output."""

import json
import sys

import numpy
import OpenEXR

with OpenEXR.File(sys.argv[1], separate_channels=True) as file:
    header, channels = file.header(), file.channels()
    pixels = {name: channel.pixels for name, channel in channels.items()}
    chromaticities = [round(float(c), 4) for c in header["chromaticities"]]
    rate = header["framesPerSecond"]
    alpha, depth, light = pixels["A"], pixels["Z"], pixels["transmittance.Y"]
    figure, nothing = alpha > 0.99, alpha == 0
    print(
        json.dumps(
            {
                "channels": {name: str(plane.dtype) for name, plane in pixels.items()},
                "size": [alpha.shape[1], alpha.shape[0]],
                "compression": str(header["compression"]).split(".")[-1],
                "chromaticities": chromaticities,
                "rate": [rate.numerator, rate.denominator],
                "frame": int(header["frame"]),
                "comments": header["comments"],
                "finite": all(bool(numpy.isfinite(plane).all()) for plane in pixels.values()),
                "covered": float(figure.mean()),
                "clear": float(nothing.mean()),
                "light_where_clear": float(max(abs(pixels[c][nothing]).max() for c in "RGB")),
                "nearest_m": float(depth.min()),
                "farthest_covered_m": float(depth[figure].max()),
                "depth_where_clear": float(depth[nothing].min()),
                "transmittance": [float(light.min()), float(light.max())],
            }
        )
    )
