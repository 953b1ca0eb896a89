#!/usr/bin/env python3
"""Holds every #include against the layers of tools/layers.txt.

A layer may include itself and everything below it. A layer's private headers (src/<layer>/x.hpp, included as
"<layer>/x.hpp") are its own; a test's helper (tests/<layer>/x.hpp) counts as its layer. Some libraries may be seen
only in some folders, and never in a public header. A layer's names stand in its own namespace. Prints file:line and the reason; exit code 1 when something is wrong.
"""
import argparse
import pathlib
import re
import sys

SOURCES = {".hpp", ".cpp", ".h", ".cc"}
# Library (start of the include) -> folders that may include it. Public headers are in none: whoever uses Mottle's
# headers shall not need these packages.
CONFINED = {
    "openturns/": ["modules/openturns", "tests/stats", "benchmarks"],
    "toml++/": ["src", "apps", "tests"],
    "nlohmann/": ["src", "apps", "tests"],
    "CLI/": ["apps"],
    "Random123/": ["src/core", "tests/core"],
    "xxhash": ["src/core"],
    # Decompositions of matrices of any size are compiled once, in src/linalg/dense; fem takes those of fixed sizes.
    "Eigen/Cholesky": ["src/linalg", "src/fem", "tests", "benchmarks", "validation"],
    "Eigen/Dense": ["tests", "benchmarks", "validation", "examples"],
    "Eigen/Eigenvalues": ["src/linalg", "src/dynamics/modes", "tests", "benchmarks", "validation"],
    "Eigen/QR": ["src/linalg", "src/stats/surrogates", "tests", "benchmarks", "validation"],
    "Eigen/SVD": ["src/linalg", "tests", "benchmarks", "validation"],
}
UMBRELLA = "include/mottle/mottle.hpp"  # what a program that uses the library includes, of every layer
NAMESPACES = "include/mottle/layers.hpp"  # which names each layer sees
NAMESPACE = re.compile(r"^namespace mottle(?:::(\w+))?\b")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


def read_table(path):
    """layers.txt -> {layer: set of layers it names directly}."""
    table = {}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        layer, separator, lower = line.partition(":")
        if not separator:
            raise SystemExit(f"{path}:{number}: expected 'layer: lower layers', found '{line}'")
        unknown = [name for name in lower.split() if name not in table]
        if unknown:  # only what stands above it in the file: so there is no cycle either
            raise SystemExit(f"{path}:{number}: {layer} uses {', '.join(unknown)}, not defined above it")
        table[layer.strip()] = set(lower.split())
    return table


def close_over(table):
    """{layer: everything it may include, itself too}."""
    allowed = {}
    for layer, lower in table.items():
        allowed[layer] = {layer}.union(*(allowed[name] for name in lower))
    return allowed


def layer_of(parts):
    """Layer of a file, from its path's folders; None where every layer may be used (tests/support and the like)."""
    if parts[0] == "apps":
        return "apps"
    if parts[:2] == ("include", "mottle") and len(parts) > 3:
        return parts[2]
    if parts[0] == "src" and len(parts) > 2:
        return parts[1]
    if parts[0] == "tests" and len(parts) > 2:
        return parts[1]
    return None


def check_include(root, path, included, layer, allowed):
    """Reason why a file of `layer` must not include `included`, or None."""
    for library, folders in CONFINED.items():
        if included.startswith(library) and not any(path.startswith(folder + "/") for folder in folders):
            return f"{included}: only {', '.join(folders)} may include {library}*"
    if "../" in included:
        return f"{included}: name it from include/ or src/, a relative path hides the layer"
    head, _, rest = included.partition("/")
    if head == "mottle" and "/" in rest:
        target = rest.split("/")[0]
        if target not in allowed:
            return f"{included}: no layer '{target}' in tools/layers.txt"
        if layer is not None and target not in allowed[layer]:
            return f"{included}: layer {layer} may not include {target}, only {', '.join(sorted(allowed[layer]))}"
    elif rest and head in allowed and layer is not None and head != layer:
        is_helper = path.startswith("tests/") and (root / "tests" / included).is_file()
        if is_helper and head in allowed[layer]:
            return None
        return f"{included}: private header of layer {head}"
    return None


def namespace_of(layer):
    return "mottle" if layer == "core" else f"mottle::{layer}"


def check_sources(root, allowed):
    for folder in ("include", "src", "apps", "tests", "benchmarks"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SOURCES or not file.is_file():
                continue
            relative = file.relative_to(root)
            layer = layer_of(relative.parts)
            if layer not in allowed:
                if folder in ("include", "src") and relative.as_posix() not in (UMBRELLA, NAMESPACES):
                    yield f"{relative}:1: belongs to no layer of tools/layers.txt"
                    continue
                layer = None
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                reason = match and check_include(root, relative.as_posix(), match.group(1), layer, allowed)
                if reason:
                    yield f"{relative}:{number}: {reason}"
                opened = NAMESPACE.match(line) if folder in ("include", "src") and layer is not None else None
                if opened and (opened.group(1) not in allowed[layer] if layer != "core" else opened.group(1)):
                    yield f"{relative}:{number}: {opened.group()} in layer {layer}, whose namespace is {namespace_of(layer)}"


def check_build(root, table):
    """The build links by the same table: mottle_layer(NAME USES ...) in CMakeLists.txt."""
    cmake = root / "CMakeLists.txt"
    if not cmake.exists():
        return
    for number, line in enumerate(cmake.read_text().splitlines(), 1):
        match = re.match(r"\s*mottle_layer\((\w+)(?:\s+USES((?:\s+[a-z_]+)+))?", line)
        if match and set((match.group(2) or "").split()) != table.get(match.group(1)):
            yield f"CMakeLists.txt:{number}: layer {match.group(1)} and tools/layers.txt disagree on what it uses"


def check_namespaces(root, table):
    """Each layer's namespace sees those of the same table."""
    file = root / NAMESPACES
    if not file.exists():
        return
    text = file.read_text()
    seen = {name: set(re.findall(r"using namespace (\w+);", body))
            for name, body in re.findall(r"^namespace (\w+) \{([^{}]*)\}", text, re.MULTILINE)}
    for layer, lower in table.items():
        if layer != "core" and seen.get({"apps": "app"}.get(layer, layer)) != lower - {"core"}:
            yield f"{NAMESPACES}:1: layer {layer} and tools/layers.txt disagree on what it sees"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root
    table = read_table(root / "tools/layers.txt")
    violations = [*check_sources(root, close_over(table)), *check_build(root, table), *check_namespaces(root, table)]
    print("\n".join(violations) if violations else f"layers: every #include agrees with {root / 'tools/layers.txt'}")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
