"""Builds a site of the Markdown pages: what README.md links to, directly or by way of other pages.

    pip install mkdocs-material latex2mathml
    python3 scripts/site.py                # target/site/index.html

Pages keep their places, so that links lead to the same files here, on a forge and on the site; linked files that are no
pages are copied. Equations become MathML, which needs no script and no network. A link that leads nowhere is an error.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "target" / "site-source"
LINK = re.compile(r"\]\(([^)#\s]+)")
EQUATION = re.compile(r"^\$\$(.+?)\$\$$", re.DOTALL | re.MULTILINE)


def linked() -> list[Path]:
    """Files that README.md leads to, relative to the root of the repository."""
    found, waiting = [], [Path("README.md")]
    while waiting:
        page = waiting.pop()
        if page in found:
            continue
        found.append(page)
        if page.suffix == ".md":
            targets = [target for target in LINK.findall((ROOT / page).read_text()) if "://" not in target]
            waiting += [(ROOT / page.parent / target).resolve().relative_to(ROOT) for target in targets]
    return found


def main() -> None:
    """Copies the pages and has mkdocs build them."""
    from latex2mathml.converter import convert

    shutil.rmtree(SOURCE, ignore_errors=True)
    for page in linked():
        copy = SOURCE / page
        copy.parent.mkdir(parents=True, exist_ok=True)
        if page.suffix == ".md":
            text = EQUATION.sub(lambda found: convert(found[1], display="block"), (ROOT / page).read_text())
            copy.write_text(text)
        else:
            shutil.copy(ROOT / page, copy)
    (SOURCE / "site.css").write_text(".md-grid { max-width: 90rem; }\n")  # room for tables and commands
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    build = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--config-file", ROOT / "mkdocs.yml"]
    sys.exit(subprocess.run(build, check=False, env=environment).returncode)


if __name__ == "__main__":
    main()
