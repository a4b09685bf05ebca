# Part of the extension of vtex for Inkscape.
"""Find the program vtex, run it, and keep its results for the next preview."""

from __future__ import annotations

import getpass
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from inkex import AbortExtension

MISSING = """The program vtex was not found.

Install it (see the page of vtex), or write its full path into the field "Program" of the dialog. \
You can also set the environment variable VTEX to this path.

Searched: {searched}"""

# `vtex integrate inkscape` may write the program's path into this file beside the extension.
PATH_FILE = Path(__file__).with_name("vtex_program.txt")
CACHE_SECONDS = 24 * 3600
CACHE_BYTES = 300_000_000


def find_program(named: str | None) -> str:
    """Return the path of vtex: from the dialog, VTEX, the file beside the extension, PATH, or a usual folder."""
    named = (named or "").strip()
    if named:
        found = shutil.which(os.path.expanduser(named))
        if found:
            return found
        raise AbortExtension(MISSING.format(searched=named))
    name = "vtex.exe" if sys.platform == "win32" else "vtex"
    written = PATH_FILE.read_text("utf-8").strip() if PATH_FILE.is_file() else ""
    folders = [
        Path.home() / ".cargo/bin",
        Path.home() / ".local/bin",
        Path("/usr/local/bin"),
        Path("/opt/homebrew/bin"),
    ]
    if os.environ.get("LOCALAPPDATA"):
        folders.append(Path(os.environ["LOCALAPPDATA"]) / "Programs" / "vtex")
    candidates = [os.environ.get("VTEX", ""), written, name, *(str(folder / name) for folder in folders)]
    candidates = [candidate for candidate in candidates if candidate]
    for candidate in candidates:
        found = shutil.which(candidate)
        if found:
            return found
    raise AbortExtension(MISSING.format(searched=", ".join(candidates)))


class Program:
    """One vtex program, with a limit of seconds for each call."""

    def __init__(self, named: str | None, limit: float) -> None:
        self.path = find_program(named)
        self.limit = limit
        status = os.stat(self.path)
        self.identity = f"{self.path} {status.st_size} {status.st_mtime_ns}"

    def run(self, arguments: list[str]) -> dict[str, Any]:
        """Run vtex and return its summary. An error ends the extension with the text that vtex wrote."""
        command = [self.path, *arguments, "--json", "--quiet", "--color", "never"]
        code, output, errors = run_command(command, self.limit)
        if code != 0:
            raise AbortExtension(errors.strip() or f"vtex ended with the code {code} and no message.")
        try:
            summary: dict[str, Any] = json.loads(output)
            return summary
        except ValueError as error:
            raise AbortExtension(f"'{self.path}' is not vtex: it wrote no summary.") from error


def run_command(command: list[str], limit: float) -> tuple[int, str, str]:
    """Run a program; return its exit code, output and messages. It ends with the extension and at the time limit."""
    flags = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # Only on Windows.
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            creationflags=flags,
        )
    except OSError as error:
        raise AbortExtension(f"Cannot start '{command[0]}': {error.strerror}") from error
    # Cancel in Inkscape ends this process with SIGTERM: the program must not go on alone.
    before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    try:
        output, errors = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired as error:
        raise AbortExtension(
            f"'{Path(command[0]).name}' took longer than {limit:.0f} s and was stopped.\n"
            "hint: choose the quality 'draft', a larger scale or a smaller shape, or raise the time limit"
        ) from error
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
        signal.signal(signal.SIGTERM, before)
    return process.returncode, output, errors


class Cache:
    """Results in the temporary folder, so that a preview with the same settings needs no time."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or Path(tempfile.gettempdir()) / f"vtex-inkscape-{getpass.getuser()}"
        self.folder.mkdir(mode=0o700, exist_ok=True)
        status = self.folder.lstat()
        # In a shared temporary folder, somebody else could have made it.
        if hasattr(os, "getuid") and (status.st_uid != os.getuid() or self.folder.is_symlink()):
            raise AbortExtension(f"The folder '{self.folder}' belongs to another user. Remove it and try again.")

    def get(self, key: list[str], suffix: str, make: Callable[[Path], None]) -> Path:
        """Return the file for this key. If there is none, `make` writes it."""
        name = hashlib.sha256("\0".join(key).encode()).hexdigest()[:32]
        path = self.folder / f"{name}{suffix}"
        if path.is_file():
            os.utime(path)
            return path
        self.prune()
        # vtex chooses the format by the suffix, so the unfinished file has the same one.
        unfinished = self.folder / f"{name}.{os.getpid()}{suffix}"
        try:
            make(unfinished)
            os.replace(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)
        return path

    def prune(self) -> None:
        """Remove files that were not used for a day, then the oldest until the folder is small."""
        files = sorted(
            ((entry.stat().st_mtime, entry.stat().st_size, entry.path) for entry in os.scandir(self.folder)),
            reverse=True,
        )
        total = 0
        for used, size, path in files:
            total += size
            if total > CACHE_BYTES or time.time() - used > CACHE_SECONDS:
                Path(path).unlink(missing_ok=True)


def digest(path: Path) -> str:
    """Return the hash of a file's content."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise AbortExtension(f"Cannot read '{path}': {error.strerror}") from error


def make_library(program: Program, cache: Cache, source: Path, options: list[str]) -> Path:
    """Return a library: the source itself, or what vtex finds in this photograph or drawing."""
    if source.name.lower().endswith((".lib.json", ".lib.json.gz")):
        return source
    key = [program.identity, source.name, digest(source), *options]

    # The library stores the name of its exemplar, so vtex reads the source itself.
    def analyze(output: Path) -> None:
        program.run(["analyze", str(source), "-o", str(output), *options])

    return cache.get(key, ".lib.json", analyze)


def make_texture(program: Program, cache: Cache, library: Path, domain: str | None, options: list[str]) -> Path:
    """Return an SVG of a texture; `domain` is an SVG of the shape to fill."""
    key = [program.identity, digest(library), domain or "", *options]

    def synth(output: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="vtex-") as folder:
            arguments = ["synth", str(library), "-o", str(output), *options]
            if domain is not None:
                shape = Path(folder) / "shape.svg"
                shape.write_text(domain, encoding="utf-8")
                arguments += ["--domain", str(shape)]
            program.run(arguments)

    return cache.get(key, ".svg", synth)
