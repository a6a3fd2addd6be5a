#!/usr/bin/env python3
"""Writes the tables of data_schema/SCHEMA.md from the JSON schemas; --check only says whether they are up to date."""

import json
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "data_schema"
BEGIN, END = "<!-- tables: written by scripts/document-schemas.py -->\n", "<!-- end of tables -->\n"


def resolve(node, file):
    """`node` without $ref, and the file that its own references are relative to."""
    parts = [part for part in node.get("allOf", []) if "$ref" in part]
    reference = node.get("$ref") or (parts[0]["$ref"] if parts else None)
    if reference is None:
        return node, file
    target, _, pointer = reference.partition("#/")
    target = target or file
    found = json.loads((FOLDER / "schemas" / target).read_text())
    for key in pointer.split("/"):
        found = found[key]
    found, origin = resolve(found, target)
    return {**found, **{k: v for k, v in node.items() if k not in ("$ref", "allOf")}}, origin


def number_range(node):
    low = "(" + str(node["exclusiveMinimum"]) if "exclusiveMinimum" in node else "[" + str(node.get("minimum"))
    high = str(node["exclusiveMaximum"]) + ")" if "exclusiveMaximum" in node else str(node.get("maximum")) + "]"
    return f"{low}, {high}"


def allowed(node, file):
    """Type and range in few words."""
    node, file = resolve(node, file)
    if "const" in node:
        return f"`{json.dumps(node['const'])}`"
    if "enum" in node:
        return ", ".join(f"`{json.dumps(name)}`" for name in node["enum"])
    if "oneOf" in node:
        return "; or ".join(allowed(option, file) for option in node["oneOf"])
    kind = node["type"]
    if kind == "integer":
        return "integer in " + number_range(node)
    if kind == "number":
        return "number in " + number_range(node)
    if kind == "array":
        least, most = node.get("minItems", 0), node["maxItems"]
        return f"{least if least == most else f'{least} to {most}'} of: {allowed(node['items'], file)}"
    return {"boolean": "true, false", "string": "text"}.get(kind, kind)


def rows(node, file, prefix=""):
    node, file = resolve(node, file)
    for key, child in node["properties"].items():
        needed = key in node.get("required", [])
        full, origin = resolve(child, file)
        path = f"{prefix}{key}"
        default = "required" if needed else f"`{json.dumps(full['default'])}`" if "default" in full else ""
        yield f"| `{path}` | {full.get('description', '')} | {allowed(child, file)} | {default} |"
        inner, inner_path = full, path
        if full.get("type") == "array":
            (inner, origin), inner_path = resolve(full["items"], origin), path + "[]"
        if "properties" in inner and not (prefix == "" and key in ("material", "bake")):
            yield from rows(inner, origin, inner_path + ".")


def tables():
    for name in ("hairstyle", "scene", "simulation", "bake", "material"):
        file = f"{name}.schema.json"
        schema = json.loads((FOLDER / "schemas" / file).read_text())
        yield f"### {schema['title']}: `schemas/{file}`\n"
        yield "| key | meaning [unit] | type and range | default |\n|---|---|---|---|"
        yield "\n".join(rows(schema, file)) + "\n"


def main():
    path = FOLDER / "SCHEMA.md"
    text = path.read_text()
    before, _, rest = text.partition(BEGIN)
    after = rest.partition(END)[2]
    wanted = before + BEGIN + "\n" + "\n".join(tables()) + "\n" + END + after
    if "--check" in sys.argv[1:]:
        if wanted != text:
            sys.exit("SCHEMA.md is not what the schemas say: run scripts/document-schemas.py")
        return
    path.write_text(wanted)


main()
