"""Pack the program for a release.

Usage: pack.py TARGET PROGRAM LICENCES FOLDER

The archive and the folder in it have the name that cargo-binstall looks for by default.
"""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# The file of each shell, under the name that the shell looks for where it looks for one.
COMPLETIONS = {
    "bash": "vtex.bash",
    "elvish": "vtex.elv",
    "fish": "vtex.fish",
    "powershell": "_vtex.ps1",
    "zsh": "_vtex",
}


def pack(target: str, program: Path, licences: Path, folder: Path) -> Path:
    """Write the archive to a folder and return its path."""
    version = subprocess.check_output([program, "--version"], text=True).split()[1]
    content = folder / f"vtex-{target}-v{version}"
    completions = content / "completions"
    completions.mkdir(parents=True)
    shutil.copy(program, content)
    shutil.copy(licences, content / "dependencies.html")
    shutil.copy(ROOT / "examples/exemplars/terrazzo.png", content)
    for name in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"]:
        shutil.copy(ROOT / name, content)
    for shell, name in COMPLETIONS.items():
        (completions / name).write_bytes(subprocess.check_output([program, "completions", shell]))
    subprocess.check_call([program, "man", content / "man"])
    kind = "zip" if "windows" in target else "gztar"
    archive = shutil.make_archive(str(content), kind, root_dir=folder, base_dir=content.name)
    shutil.rmtree(content)
    return Path(archive)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    target, program, licences, folder = sys.argv[1:]
    print(pack(target, Path(program).resolve(), Path(licences), Path(folder)))
