#!/usr/bin/env python3
"""Writes the licences of all crates that the program contains, with their texts and those of bundled fonts.

    packaging/licences.py OUT.txt

Reads `cargo metadata` for this machine's system and the crates' folders in cargo's registry. Fails on a crate whose
licence deny.toml does not allow. A text that several crates share is written once; those of crates that come without
one are Catchlight's own MIT and Apache-2.0, as their authors state.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TEXTS = re.compile(r"^(licen[cs]e|copying|copyright|notice|ofl|ufl|unlicense)", re.IGNORECASE)


def contained_packages():
    """Returns the packages that the program is linked from: no build scripts, procedural macros or tests."""
    host = subprocess.run(["rustc", "-vV"], check=True, stdout=subprocess.PIPE, text=True).stdout
    target = re.search("host: (.*)", host).group(1)
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", target]
    data = json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
    nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
    packages = {package["id"]: package for package in data["packages"]}
    found, open_ids = set(), [data["resolve"]["root"]]
    while open_ids:
        package_id = open_ids.pop()
        if package_id in found:
            continue
        found.add(package_id)
        normal = (dep for dep in nodes[package_id]["deps"] if any(kind["kind"] is None for kind in dep["dep_kinds"]))
        open_ids.extend(dep["pkg"] for dep in normal)
    found.discard(data["resolve"]["root"])
    return sorted((packages[package_id] for package_id in found), key=lambda p: (p["name"], p["version"]))


def is_allowed(expression, allowed):
    """Evaluates an SPDX expression: AND, OR, WITH and parentheses; `/` is an old OR."""
    tokens = re.findall(r"[()]|[^\s()]+", expression.replace("/", " OR "))
    terms, words = [], []
    for token in tokens + ["AND"]:
        if token in ("AND", "OR", "(", ")"):
            if words:
                terms.append(str(" ".join(words) in allowed))
                words = []
            terms.append({"AND": "and", "OR": "or"}.get(token, token))
        else:
            words.append(token)
    return eval(" ".join(terms[:-1]))  # of True, False, and, or, ( and ) alone


def texts_of(package):
    """Returns the licence texts in a crate's folder and in those of its fonts, by name."""
    folder = pathlib.Path(package["manifest_path"]).parent
    named = [path for path in folder.iterdir() if path.is_file() and TEXTS.match(path.name)]
    fonts = [path for path in folder.glob("fonts/*.txt")]
    if package["license_file"]:
        named.append(folder / package["license_file"])
    return {path: path.read_text(errors="replace").strip() for path in sorted(set(named + fonts))}


def main():
    allowed = set(re.findall(r'^    "([^"]+)",$', (ROOT / "deny.toml").read_text(), re.MULTILINE))
    packages = contained_packages()
    refused = [p for p in packages if not p["license"] or not is_allowed(p["license"], allowed)]
    for package in refused:
        print(f"not allowed by deny.toml: {package['name']} {package['version']}: {package['license']}", file=sys.stderr)
    users = {}
    for package in packages:
        for path, text in texts_of(package).items():
            font = f", {path.name}" if path.parent.name == "fonts" else ""
            users.setdefault(re.sub(r"\s+", " ", text), (text, []))[1].append(f"{package['name']}{font}")
    own = [(path.read_text().strip(), ["Catchlight"]) for path in sorted(ROOT.glob("LICENSE-*"))]
    own.append(((ROOT / "assets/denoiser/LICENSE.txt").read_text().strip(), ["weights of the denoiser"]))
    lines = [
        "Catchlight is licensed under MIT or Apache-2.0, as you like; so are its figures, whose body data are made from",
        "MakeHuman's (CC0). The weights of its denoiser are those of Intel Open Image Denoise, copyright Intel",
        "Corporation, under the Apache License, Version 2.0. It contains these libraries:",
        "",
    ]
    lines += [f"{p['name']} {p['version']}: {p['license']} {p['repository'] or ''}".rstrip() for p in packages]
    for text, names in own + sorted(users.values(), key=lambda entry: -len(entry[1])):
        lines += ["", "=" * 80, ", ".join(sorted(set(names))), "=" * 80, "", text]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n")
    without = [p["name"] for p in packages if not texts_of(p)]
    print(f"{len(packages)} crates, {len(users)} texts; {len(without)} crates come without a text: {', '.join(without)}")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
