"""Print the Homebrew formula of a release.

Usage: fill.py VERSION OWNER/REPOSITORY SHA256SUMS
"""

import re
import sys
from pathlib import Path

TEMPLATE = Path(__file__).with_name("vtex.rb")


def fill(version: str, repository: str, sums: str) -> str:
    """Replace all marks `@NAME@` of the template; a mark without a value is an error."""
    values = {"VERSION": version, "REPOSITORY": repository}
    for line in sums.splitlines():
        checksum, name = line.split()
        values[name.removeprefix("vtex-").removesuffix(".zip").removesuffix(f"-v{version}.tar.gz")] = checksum
    return re.sub("@([A-Za-z0-9_-]+)@", lambda mark: values[mark[1]], TEMPLATE.read_text("utf-8"))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    version, repository, sums = sys.argv[1:]
    print(fill(version, repository, Path(sums).read_text("utf-8")), end="")
