"""Throughput of two workers against one, for each engine: python engines.py [PHOTOS] [ROUNDS] [ENGINE...].

The cluster is up and its workers have made a texture each before the clock starts.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import vtex

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples"))
EXEMPLARS = Path(__file__).resolve().parents[2] / "examples" / "exemplars"


def photographs(folder: Path, number: int) -> None:
    """Parts of the exemplars, 192 x 192 pixels."""
    draw = np.random.default_rng(1)
    exemplars = [Image.open(path).convert("RGB") for path in sorted(EXEMPLARS.glob("*.png"))]
    for k in range(number):
        exemplar = exemplars[k % len(exemplars)]
        left, top = draw.integers(0, np.array(exemplar.size) - 192)
        exemplar.crop((left, top, left + 192, top + 192)).save(folder / f"{k:03}.png")


def of_ray(workers: int) -> Callable[[str, str], Any]:
    """Ray Data with a cluster that is up."""
    import ray
    import ray_textures

    ray.shutdown()
    ray.init(num_cpus=workers + 1, include_dashboard=False, logging_level="ERROR", log_to_driver=False)
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


def main(number: int = 24, rounds: int = 3) -> None:
    """Print photographs each second by engine and number of workers, the best of some rounds."""
    with tempfile.TemporaryDirectory() as folder:
        photos, few, out = (Path(folder) / name for name in ("photos", "few", "out"))
        for made in (photos, few, out):
            made.mkdir()
        photographs(photos, number)
        photographs(few, 2)
        vtex.set_threads(1)
        began = time.perf_counter()
        for path in sorted(photos.iterdir()):
            vtex.synthesize(vtex.analyze(path), 600, seed=7).svg()
        print(f"plain loop, one thread: {number / (time.perf_counter() - began):.2f} photographs a second")
        engines = sys.argv[3:] or ["ray", "dask", "spark"]
        for name in engines:
            best = {}
            for workers in (1, 2):
                run = {"ray": of_ray, "dask": of_dask, "spark": of_spark}[name](workers)
                run(str(few), str(out))
                times = []
                for _ in range(rounds):
                    began = time.perf_counter()
                    rows = run(str(photos), str(out))
                    times.append(time.perf_counter() - began)
                    assert len(rows) == number and not any(row["error"] for row in rows)
                best[workers] = number / min(times)
                load = os.getloadavg()[0]
                print(f"{name}, {workers}: {best[workers]:.2f} a second, best of {times}, load {load:.1f}", flush=True)
                if name == "spark":
                    # The next session gets another number of cores.
                    from pyspark.sql import SparkSession

                    SparkSession.getActiveSession().stop()
            print(f"{name}: {best[2] / best[1]:.2f} times as many with two workers", flush=True)


if __name__ == "__main__":
    import warnings

    warnings.filterwarnings("ignore", category=vtex.VtexWarning)
    main(*map(int, sys.argv[1:3]))
