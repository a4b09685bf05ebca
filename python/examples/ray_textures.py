"""Textures of a folder of photographs by Ray Data: python ray_textures.py PHOTOS OUT [WORKERS]."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import ray

import vtex


class Maker:
    """An actor, which stays: it loads the network once and works on a single core."""

    def __init__(self, out: str) -> None:
        vtex.set_threads(1)
        self.out = Path(out)

    def __call__(self, batch: dict[str, Any]) -> dict[str, Any]:
        errors = [self.make(Path(path), data) for path, data in zip(batch["path"], batch["bytes"], strict=True)]
        return {"path": batch["path"], "error": np.array(errors, dtype=object)}

    def make(self, path: Path, data: bytes) -> str:
        try:
            library = vtex.analyze(data, name=path.name)
            vtex.synthesize(library, 600, seed=7).save(self.out / f"{path.stem}.svg", force=True)
        except vtex.Error as error:  # A row that says so, not the end of all work.
            return f"{error} ({error.hint})"
        return ""


def main(photos: str, out: str, workers: int = 2) -> list[dict[str, Any]]:
    """Give a row for each photograph: its path, and what went wrong or nothing."""
    # As bytes: read_images would fail as a whole at the first damaged photograph.
    # Half a core by the books for each, so that readers find room beside as many actors as cores.
    half = {"num_cpus": 0.5}
    rows = ray.data.read_binary_files(photos, include_paths=True, override_num_blocks=4 * workers, ray_remote_args=half)
    actors = ray.data.ActorPoolStrategy(size=workers)
    rows = rows.map_batches(Maker, fn_constructor_args=[out], batch_size=1, compute=actors, **half)
    return list(rows.take_all())


if __name__ == "__main__":
    folder, results, *number = sys.argv[1:]
    for row in main(folder, results, *map(int, number)):
        print(row["path"], row["error"] or "done")
