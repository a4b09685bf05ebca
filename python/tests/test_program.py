"""The same bytes as the program writes."""

import subprocess

import pytest

import vtex


@pytest.fixture(scope="module")
def made(program, photo_path, tmp_path_factory):
    """A folder with what the program makes of the photograph."""
    folder = tmp_path_factory.mktemp("program")

    def run(*arguments: object) -> None:
        command = [program, *map(str, arguments), "--seed", "7", "--quiet"]
        subprocess.run(command, check=True, cwd=folder)

    run("analyze", photo_path, "--segmenter", "texton", "-o", "p.lib.json")
    run(
        "synth", "p.lib.json", "--size", "300x200", "-o", "p.svg", "-o", "p.scene.json.gz", "-o", "p.pdf", "-o", "p.png"
    )
    run("synth", "p.lib.json", "--size", "256", "--tile", "-o", "tile.svg", "--precision", "2", "--css")
    run("synth", "p.lib.json", "--size", "300", "-o", "small.svgz", "--max-bytes", "25kB", "--background", "navy")
    return folder


def test_one_seed_gives_the_same_bytes(made, photo_path, tmp_path):
    library = vtex.analyze(photo_path, seed=7)
    library.save(tmp_path / "p.lib.json")
    scene = vtex.synthesize(library, (300, 200), seed=7)
    for name in ("p.svg", "p.scene.json.gz", "p.pdf", "p.png"):
        scene.save(tmp_path / name)
    vtex.synthesize(library, 256, tile="both", seed=7).save(tmp_path / "tile.svg", precision=2, css=True)
    small = vtex.synthesize(library, 300, seed=7)
    small.save(tmp_path / "small.svgz", max_bytes=25000, background="navy")
    for path in sorted(made.iterdir()):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_documents_of_the_program_are_read(made):
    library = vtex.Library.read(made / "p.lib.json")
    assert vtex.synthesize(library, (300, 200), seed=7) == vtex.Scene.read(made / "p.scene.json.gz")
