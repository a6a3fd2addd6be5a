#!/usr/bin/env python3
"""Writes a ladder of settings for --budget-ms and --target-error: the points of the fronts of reference scenes.

  scripts/make-ladder.py DIAGRAM TRADEOFF.json... LADDER.json

Each tradeoff.json is of one reference scene (`pelage tradeoff`), all of the same knobs. A candidate is a point that was
measured on every scene and is on the front of one at least. It states every place in which candidates differ, so that it
means the same on any scene; what a row leaves out is its scene's own value. Points with another value in a place of
--without are no candidates: settings that change what is drawn, or what does not converge.
"""

import argparse
import json
from pathlib import Path


def word(value):
    return value if isinstance(value, str) else json.dumps(value)


def own_value(scene, place):
    """Of a place in a scene's JSON."""
    for part in place.split("."):
        scene = scene[int(part)] if isinstance(scene, list) else scene[part]
    return word(scene)


def on_front(points):
    """Indices of points (error, ms) that no other dominates."""
    front, least = [], float("inf")
    for i in sorted(range(len(points)), key=lambda i: (points[i][1], points[i][0])):
        if points[i][0] < least:
            least = points[i][0]
            front.append(i)
    return front


def read(file, diagram):
    """Name, scene and usable rows: [(settings, error, ms)]."""
    document = json.loads(file.read_text())
    found = [d for d in document["diagrams"] if d["id"] == diagram]
    if not found:
        raise SystemExit(f"{file}: there is no diagram '{diagram}'")
    # An error of 0 is the truth's own run; it has no place on a logarithmic scale.
    rows = [
        (dict(s.split("=", 1) for s in row["settings"]), row["error"], row["time"]["median_ms"])
        for row in found[0]["rows"]
        if not row["failed"] and row["error"] > 0
    ]
    return document["name"], document["scene"], rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("diagram")
    parser.add_argument("tradeoffs", nargs="+", type=Path, metavar="TRADEOFF.json")
    parser.add_argument("ladder", type=Path, metavar="LADDER.json")
    parser.add_argument("--without", action="append", default=[], metavar="PLACE", help="a place that is not to be chosen")
    o = parser.parse_args()
    scenes = [read(file, o.diagram) for file in o.tradeoffs]
    places = sorted({place for _, _, rows in scenes for settings, _, _ in rows for place in settings} - set(o.without))
    measured = []  # [scene] {values of all places: (error, ms)}
    for _, scene, rows in scenes:
        points = {}
        for settings, error, ms in rows:
            if not settings.keys() & set(o.without):
                points.setdefault(tuple(settings.get(p, own_value(scene, p)) for p in places), (error, ms))
        measured.append(points)
    common = [values for values in measured[0] if all(values in points for points in measured)]
    chosen = {values for points in measured for values in (common[i] for i in on_front([points[v] for v in common]))}
    candidates = sorted(chosen, key=lambda values: sum(points[values][1] for points in measured))
    differing = [i for i in range(len(places)) if len({values[i] for values in chosen}) > 1]
    ladder = {
        "diagram": o.diagram,
        "scenes": [name for name, _, _ in scenes],
        "candidates": [
            {
                "settings": [f"{places[i]}={values[i]}" for i in differing],
                "error": [float(f"{points[values][0]:.4g}") for points in measured],
                "ms": [float(f"{points[values][1]:.4g}") for points in measured],
            }
            for values in candidates
        ],
    }
    lines = ",\n    ".join(json.dumps(c) for c in ladder["candidates"])
    o.ladder.write_text(
        f'{{\n  "diagram": {json.dumps(o.diagram)},\n  "scenes": {json.dumps(ladder["scenes"])},\n'
        f'  "candidates": [\n    {lines}\n  ]\n}}\n'
    )
    print(f"{o.ladder}: {len(candidates)} candidates of {len(common)} points, {len(scenes)} scenes")


if __name__ == "__main__":
    main()
