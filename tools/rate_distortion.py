"""A chart of error by bytes: `vtex vectorize` beside vtracer, on photographs of your own.

    python tools/rate_distortion.py VTEX CHART.svg PHOTO...

VTEX is the program. Needs numpy, Pillow, matplotlib, and vtracer, either the package 0.6 or 1.0.

Each photograph is traced by vtex at several values of --fidelity, and by vtracer with its default, its preset for
photographs, and a grid of its settings. Each SVG is drawn by `vtex render`, which is resvg, and compared with the
photograph: PSNR over all channels, in dB. Bytes are those of `gzip -9`. The table on standard output has, for each
photograph, the least bytes of vtex at the PSNR of each preset of vtracer, and the difference in dB at six budgets,
spaced evenly by ratio over the bytes that both programs reach. A value between two runs of vtex is interpolated;
of vtracer the best run within the budget counts.
"""

import gzip
import itertools
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy as np
import vtracer
from PIL import Image

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

FIDELITIES = [0.1, 0.25, 0.5, 0.75, 1, 1.5, 2.5, 5]
BUDGETS = 6
TICKS = [10, 20, 50, 100, 200, 500, 1000, 2000, 5000]
PRESETS = {
    "default": {},
    # Those of the program's `--preset photo`.
    "photo": {"filter_speckle": 10, "color_precision": 8, "layer_difference": 48, "corner_threshold": 180},
}
GRID = [
    {"filter_speckle": speckle, "color_precision": precision, "layer_difference": difference}
    for speckle, precision, difference in itertools.product([2, 4, 10], [6, 8], [8, 16, 32, 64])
]


def traced(photo, settings):
    """The SVG by vtracer."""
    settings = {"path_precision": 2, **settings}
    if hasattr(vtracer, "Config"):
        return vtracer.Config(**settings).convert_bytes(photo.read_bytes()).encode()
    form = photo.suffix.lstrip(".").replace("jpg", "jpeg")
    return vtracer.convert_raw_image_to_svg(photo.read_bytes(), img_format=form, **settings).encode()


class Scale:
    """Compares SVGs with one photograph."""

    def __init__(self, program, photo, folder):
        self.program, self.photo, self.folder = program, photo, folder
        self.picture = np.asarray(Image.open(photo).convert("RGB"), float)

    def run(self, *arguments):
        subprocess.run([self.program, *arguments, "--quiet", "--force"], check=True)

    def point(self, svg):
        """Packed kB and PSNR in dB."""
        path, png = self.folder / "traced.svg", self.folder / "drawn.png"
        path.write_bytes(svg)
        self.run("render", str(path), "-o", str(png))
        drawn = np.asarray(Image.open(png).convert("RGB"), float)
        error = np.mean((drawn - self.picture) ** 2)
        return len(gzip.compress(svg, 9, mtime=0)) / 1000, 10 * np.log10(255**2 / error)

    def vectorized(self, fidelity):
        path = self.folder / "vtex.svg"
        self.run("vectorize", str(self.photo), "-o", str(path), "--seed", "1", "--fidelity", str(fidelity))
        return self.point(path.read_bytes())


def at_budget(points, budget, interpolated):
    """The best PSNR within `budget` kB."""
    points = sorted(points)
    bytes_, psnr = np.array(points).T
    best = np.maximum.accumulate(psnr)
    if interpolated:
        return float(np.interp(np.log(budget), np.log(bytes_), best))
    return float(best[np.searchsorted(bytes_, budget, side="right") - 1])


def bytes_at(points, psnr):
    """The fewest kB that reach `psnr`; None where none do, or where less than the fewest would."""
    bytes_, reached = np.array(sorted(points)).T
    best = np.maximum.accumulate(reached)
    if not best[0] <= psnr <= best[-1]:
        return None
    return float(np.exp(np.interp(psnr, best, np.log(bytes_))))


def front(points):
    """The runs that none beats in both."""
    kept = []
    for point in sorted(points):
        if not kept or point[1] > kept[-1][1]:
            kept.append(point)
    return kept


def main(program, chart, photos):
    columns = min(3, len(photos))
    rows = -(-len(photos) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.4 * columns, 2.9 * rows), squeeze=False)
    for axis in axes.flat[len(photos) :]:
        axis.axis("off")
    with tempfile.TemporaryDirectory() as folder:
        for axis, photo in zip(axes.flat, photos):
            scale = Scale(program, photo, pathlib.Path(folder))
            ours = [scale.vectorized(fidelity) for fidelity in FIDELITIES]
            presets = {name: scale.point(traced(photo, settings)) for name, settings in PRESETS.items()}
            theirs = [scale.point(traced(photo, settings)) for settings in GRID] + list(presets.values())
            for name, (size, psnr) in presets.items():
                fewest = bytes_at(ours, psnr)
                share = "below all" if fewest is None else f"{fewest:.0f} kB, {fewest / size:.2f}"
                print(f"{photo.stem}: vtracer {name} {psnr:.2f} dB, {size:.0f} kB; vtex {share}")
            least = max(min(size for size, _ in ours), min(size for size, _ in theirs))
            most = min(max(size for size, _ in ours), max(size for size, _ in theirs))
            budgets = np.geomspace(least, most, BUDGETS)
            gains = [at_budget(ours, budget, True) - at_budget(theirs, budget, False) for budget in budgets]
            print(f"{photo.stem}: " + ", ".join(f"{b:.0f} kB {g:+.2f} dB" for b, g in zip(budgets, gains)), flush=True)
            axis.plot(*zip(*sorted(ours)), "o-", color="#b5472a", markersize=3, label="vtex")
            axis.plot(*zip(*front(theirs)), "s-", color="#4a6a8a", markersize=3, label="vtracer, best of a grid")
            axis.plot(*zip(*presets.values()), "x", color="#1c2b3a", label="vtracer, default and photo")
            axis.set(title=photo.stem, xscale="log", xlabel="kB, gzip", ylabel="PSNR, dB")
            low, high = axis.get_xlim()
            ticks = [tick for tick in TICKS if low <= tick <= high]
            axis.set_xticks(ticks, [str(tick) for tick in ticks])
            axis.minorticks_off()
            axis.grid(alpha=0.3)
    axes[0, 0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(chart, metadata={"Date": None} if chart.suffix == ".svg" else None)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(sys.argv[1], pathlib.Path(sys.argv[2]), [pathlib.Path(name) for name in sys.argv[3:]])
