"""Textures of a folder of photographs by Spark: python spark_textures.py PHOTOS OUT [WORKERS]."""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pandas as pd
from pyspark.sql import SparkSession

import vtex


def main(photos: str, out: str, workers: int = 2, spark: Any = None) -> list[Any]:
    """Give a row for each photograph: its path, and what went wrong or nothing."""

    def make(path: str, data: bytes) -> str:
        try:
            library = vtex.analyze(data, name=Path(path).name)
            vtex.synthesize(library, 600, seed=7).save(Path(out) / f"{Path(path).stem}.svg", force=True)
        except vtex.Error as error:  # A row that says so, not the end of all work.
            return f"{error} ({error.hint})"
        return ""

    def textures(frames: Iterable[pd.DataFrame]) -> Iterator[pd.DataFrame]:
        vtex.set_threads(1)  # One core for each worker, whose network is loaded once.
        for frame in frames:
            errors = [make(path, bytes(data)) for path, data in zip(frame.path, frame.content, strict=True)]
            yield pd.DataFrame({"path": frame.path, "error": errors})

    spark = spark or SparkSession.builder.master(f"local[{workers}]").getOrCreate()
    frame = spark.read.format("binaryFile").load(photos).select("path", "content").repartition(4 * workers)
    return list(frame.mapInPandas(textures, "path string, error string").collect())


if __name__ == "__main__":
    folder, results, *number = sys.argv[1:]
    for row in main(folder, results, *map(int, number)):
        print(row["path"], row["error"] or "done")
