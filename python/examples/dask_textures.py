"""Textures of a folder of photographs by Dask: python dask_textures.py PHOTOS OUT [WORKERS]."""

import sys
from pathlib import Path
from typing import Any

from dask.distributed import Client

import vtex


def make(path: Path, out: str) -> dict[str, str]:
    """Make the texture of a photograph; a row with its path, and what went wrong or nothing."""
    vtex.set_threads(1)  # One core for each worker, whose network is loaded once.
    try:
        library = vtex.analyze(path)
        vtex.synthesize(library, 600, seed=7).save(Path(out) / f"{path.stem}.svg", force=True)
    except vtex.Error as error:  # A row that says so, not the end of all work.
        return {"path": str(path), "error": f"{error} ({error.hint})"}
    return {"path": str(path), "error": ""}


def main(photos: str, out: str, workers: int = 2, client: Any = None) -> list[dict[str, str]]:
    """Give a row for each photograph; `client` may be that of a cluster elsewhere."""
    paths = sorted(path for path in Path(photos).iterdir() if path.is_file())
    if client is not None:
        return list(client.gather(client.map(make, paths, out=out, pure=False)))
    with Client(n_workers=workers, threads_per_worker=1, dashboard_address=None) as own:
        return main(photos, out, workers, own)


if __name__ == "__main__":
    folder, results, *number = sys.argv[1:]
    for row in main(folder, results, *map(int, number)):
        print(row["path"], row["error"] or "done")
