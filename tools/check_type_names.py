#!/usr/bin/env python3
"""Holds that a type's name stands for one type in the whole program.

Two classes of one namespace with one name in two files break the one-definition rule, and no linker says so; in two
layers they are taken for each other, by the compiler where a layer sees both, and by people. Types in unnamed namespaces, in other classes and in functions are their file's own; tests have their own programs. Prints
file:line of each definition; exit code 1 when a name has two.
"""
import argparse
import collections
import pathlib
import re
import sys

LAYERS = pathlib.Path(__file__).resolve().parent / "layers.txt"
FOLDERS = ("include", "src", "apps")
TOKENS = re.compile(
    r"""(?P<skip>//[^\n]*|/\*.*?\*/|R"(?P<mark>[^()\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|\#[^\n]*)
    |(?P<brace>[{};])|(?P<word>\w+|::|[<>():,=])""", re.VERBOSE | re.DOTALL)


def opened_by(words):
    """What a brace after these words of its statement opens: (kind, name)."""
    if words and words[0] == "template":
        depth, end = 0, 1
        for end, word in enumerate(words[1:], 1):
            depth += (word == "<") - (word == ">")
            if depth == 0:
                break
        words = words[end + 1:]
    words = [word for word in words if word not in ("inline", "export", "alignas")]
    if words[:1] == ["namespace"]:
        return "namespace", "".join(words[1:]) or None
    if not words or words[0] not in ("class", "struct", "union", "enum"):
        return "block", None
    names = words[1:]
    if names[:1] in (["class"], ["struct"]):  # enum class
        names = names[1:]
    if names[:1] == ["("]:  # alignas(64)
        names = names[names.index(")") + 1:]
    rest = names[1:2]
    if not names or "(" in names or rest in (["<"], ["::"]):  # a function's result, a specialisation, a nested type
        return "block", None
    return "type", names[0]


def definitions(text):
    """(line, qualified name) of each type with external linkage."""
    stack, words = [], []
    for match in TOKENS.finditer(text):
        if match["skip"]:
            continue
        if match["word"]:
            words.append(match["word"])
            continue
        if match["brace"] == "{":
            kind, name = opened_by(words)
            if kind == "type" and all(k == "namespace" and n for k, n in stack):
                yield text.count("\n", 0, match.start()) + 1, "::".join([n for _, n in stack] + [name])
            stack.append((kind, name))
        elif match["brace"] == "}" and stack:
            stack.pop()
        words = []


def without_layer(name, layers):
    """mottle::stats::Surrogate -> mottle::Surrogate."""
    return re.sub(rf"^mottle::({'|'.join(layers)})::", "mottle::", name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root
    layers = [line.split(":")[0] for line in LAYERS.read_text().splitlines() if ":" in line.split("#")[0]]
    places = collections.defaultdict(list)
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            for line, name in definitions(file.read_text(encoding="utf-8")):
                places[without_layer(name, layers)].append(f"{file.relative_to(root)}:{line}")
    wrong = {name: where for name, where in places.items() if len(where) > 1}
    for name, where in sorted(wrong.items()):
        print(f"{name} is defined {len(where)} times: {', '.join(where)}")
    if not wrong:
        print(f"type names: {len(places)} types, each with a name of its own")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
