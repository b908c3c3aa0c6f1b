"""The program's bill of materials: `python3 scripts/sbom.py > aurt.cdx.json` writes CycloneDX 1.5.

Everything that is compiled into the command `aurt` (with `--manifest python/Cargo.toml`: into the Python wheel), and what building it needs, as `Cargo.lock` has it: name, version, licence,
source, SHA-256 of the package, and what depends on what. `--target` leaves out what other systems need (default: this one).
Asks `cargo metadata`; downloads nothing that a build would not.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PRODUCTS = {"Cargo.toml": "aurt-cli", "python/Cargo.toml": "aurt-python"}


def host():
    """This system's name for compilers."""
    text = subprocess.run(["rustc", "-vV"], check=True, capture_output=True, text=True).stdout
    return re.search(r"^host: (.*)$", text, re.MULTILINE).group(1)


def metadata(manifest, target):
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", target, "--manifest-path", manifest]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout)


def checksums(manifest):
    """SHA-256 of packages, by name and version."""
    entries = (ROOT / manifest).with_name("Cargo.lock").read_text().split("[[package]]")
    fields = [dict(re.findall(r'^(\w+) = "(.*)"$', entry, re.MULTILINE)) for entry in entries]
    return {(f["name"], f["version"]): f["checksum"] for f in fields if "checksum" in f}


def needed(graph, root):
    """What the root needs to be built and to run, without what only tests need."""
    found, waiting = set(), [root]
    while waiting:
        package = waiting.pop()
        if package in found:
            continue
        found.add(package)
        for dependency in graph[package]["deps"]:
            if any(kind["kind"] != "dev" for kind in dependency["dep_kinds"]):
                waiting.append(dependency["pkg"])
    return found


def reference(package):
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package, sums):
    entry = {
        "type": "application" if package["name"] in PRODUCTS.values() else "library",
        "bom-ref": reference(package),
        "name": package["name"],
        "version": package["version"],
        "licenses": [{"expression": package["license"].replace("/", " OR ")}],
        "purl": reference(package),
    }
    if (digest := sums.get((package["name"], package["version"]))) is not None:
        entry["hashes"] = [{"alg": "SHA-256", "content": digest}]
    if package.get("repository"):
        entry["externalReferences"] = [{"type": "vcs", "url": package["repository"]}]
    return entry


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--target", default=host())
    parser.add_argument("--manifest", default="Cargo.toml", choices=PRODUCTS)
    arguments = parser.parse_args()
    found = metadata(arguments.manifest, arguments.target)
    packages = {package["id"]: package for package in found["packages"]}
    graph = {node["id"]: node for node in found["resolve"]["nodes"]}
    root = next(p["id"] for p in found["packages"] if p["name"] == PRODUCTS[arguments.manifest])
    kept = sorted(needed(graph, root), key=lambda p: (packages[p]["name"], packages[p]["version"]))
    sums = checksums(arguments.manifest)
    unknown = [packages[p]["name"] for p in kept if packages[p]["source"] and (packages[p]["name"], packages[p]["version"]) not in sums]
    if unknown:
        sys.exit(f"Cargo.lock has no checksum of {', '.join(unknown)}")
    needs = {
        p: sorted({reference(packages[d["pkg"]]) for d in graph[p]["deps"] if d["pkg"] in kept}) for p in kept
    }
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": component(packages[root], sums)},
        "components": [component(packages[p], sums) for p in kept if p != root],
        "dependencies": [{"ref": reference(packages[p]), "dependsOn": needs[p]} for p in kept],
    }
    json.dump(document, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
