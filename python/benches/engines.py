"""Throughput of two workers against one, for each engine: python engines.py [PHOTOS] [ENGINE...].

A cluster of one worker and one of two work at the same time, the second on twice as many photographs. So
whatever else the machine does slows both alike, and the ratio holds on a busy machine too. The clock starts
when both are up and have made a texture for each worker.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

HERE = Path(__file__).resolve().parent
EXEMPLARS = HERE.parents[1] / "examples" / "exemplars"
sys.path.insert(0, str(HERE.parent / "examples"))


def photographs(folder: Path, number: int) -> str:
    """Make parts of the exemplars, 192 x 192 pixels, in turn."""
    folder.mkdir()
    draw = np.random.default_rng(1)
    exemplars = [Image.open(path).convert("RGB") for path in sorted(EXEMPLARS.glob("*.png"))]
    for k in range(number):
        exemplar = exemplars[k % len(exemplars)]
        left, top = draw.integers(0, np.array(exemplar.size) - 192)
        exemplar.crop((left, top, left + 192, top + 192)).save(folder / f"{k:03}.png")
    return str(folder)


def of_ray(workers: int) -> Callable[[str, str], Any]:
    """Ray Data with a cluster that is up."""
    import ray
    import ray_textures

    ray.init("local", num_cpus=workers, include_dashboard=False, logging_level="ERROR", log_to_driver=False)
    ray.data.DataContext.get_current().enable_progress_bars = False
    return lambda photos, out: ray_textures.main(photos, out, workers)


def of_dask(workers: int) -> Callable[[str, str], Any]:
    """Dask with a cluster that is up."""
    import dask_textures
    from dask.distributed import Client

    client = Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    return lambda photos, out: dask_textures.main(photos, out, workers, client)


def of_spark(workers: int) -> Callable[[str, str], Any]:
    """Spark with a session that is up."""
    import spark_textures
    from pyspark.sql import SparkSession

    builder = SparkSession.builder.master(f"local[{workers}]")
    spark = builder.config("spark.ui.enabled", "false").config("spark.log.level", "ERROR").getOrCreate()
    return lambda photos, out: spark_textures.main(photos, out, workers, spark)


def work(engine: str, workers: int, number: int) -> None:
    """One of the clusters: says when it is ready, waits, and says how many seconds its photographs took."""
    with tempfile.TemporaryDirectory() as folder:
        run = {"ray": of_ray, "dask": of_dask, "spark": of_spark}[engine](workers)
        out = Path(folder) / "out"
        out.mkdir()
        run(photographs(Path(folder) / "first", workers), str(out))
        photos = photographs(Path(folder) / "photos", workers * number)
        print("ready", flush=True)
        sys.stdin.readline()
        began = time.perf_counter()
        rows = run(photos, str(out))
        print(f"seconds {time.perf_counter() - began}", flush=True)
        assert len(rows) == workers * number and not any(row["error"] for row in rows)
        # The end of a cluster takes time, which the other one may still need.
        sys.stdin.readline()


def told(child: "subprocess.Popen[str]", word: str) -> str:
    """Give what a child says after a word."""
    assert child.stdout is not None
    for line in child.stdout:
        if line.startswith(word):
            return line.removeprefix(word).strip()
    raise SystemExit(f"a cluster ended before it said '{word}'")


def compare(engine: str, number: int) -> None:
    """Print the throughput of both."""
    paths = os.pathsep.join([str(HERE.parent / "examples"), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"PYTHONPATH": paths, "PYTHONWARNINGS": "ignore", "PYSPARK_PYTHON": sys.executable}
    command = [sys.executable, __file__, "--work", engine]
    pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
    children = [
        subprocess.Popen(
            [*command, str(workers), str(number)], text=True, env=environment, stdin=pipe, stdout=pipe, stderr=nowhere
        )
        for workers in (1, 2)
    ]
    for child in children:
        told(child, "ready")
    for child in children:
        assert child.stdin is not None
        print("go", file=child.stdin, flush=True)
    seconds = [float(told(child, "seconds")) for child in children]
    load = os.getloadavg()[0]
    for child in children:
        child.communicate("end\n")
    one, two = number / seconds[0], 2 * number / seconds[1]
    ratio = f"{one:.3f} photographs a second with one worker, {two:.3f} with two, {two / one:.2f} times"
    print(f"{engine}: {ratio}; load {load:.1f}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--work"]:
        work(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
    else:
        for engine in sys.argv[2:] or ["ray", "dask", "spark"]:
            compare(engine, int(sys.argv[1]) if len(sys.argv) > 1 else 12)
