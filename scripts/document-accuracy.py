#!/usr/bin/env python3
"""Measures what accuracy costs on grooms of our own and writes docs/accuracy.md.

  scripts/document-accuracy.py [--work DIR] [--quick] [--ladders] [--only-write]

Needs build/release/bin/pelage (or --program). Sweeps are kept in --work and resumed. --ladders also measures the
reference scenes of --budget-ms and --target-error and writes runtime/tradeoff/*_ladder.json, which the next build takes
in. --only-write writes the page from sweeps that are there. Takes an hour on two cores, 20 minutes with --quick: leave
the machine alone meanwhile.
"""

import argparse
import json
import math
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# name, options of groom, options of tradeoff
SCENES = [
    ("bob", ["--style", "bob", "--strands", "3000", "--seed", "21"],
     ["--material", "blond", "--light", "0.2,0.5,1"]),
    ("curly", ["--style", "curly", "--strands", "3000", "--seed", "22"],
     ["--material", "red", "--preset", "curly", "--only", "shadow,density-map,deep-opacity,picture,truth,strands,simulation"]),
]
# Of the ladders: other grooms, lights, sizes and cameras, so that ratios between points are known for more than one kind.
PICTURES = [
    ("ref-curly", ["--style", "curly", "--strands", "2500", "--seed", "13"],
     ["--material", "red", "--light=-0.6,0.5,-0.7", "--light", "0.5,0.5,1,0.3", "--size", "160x120"]),
    ("ref-bob", ["--style", "bob", "--strands", "4000", "--seed", "11"],
     ["--material", "blond", "--light", "0.2,0.5,1", "--size", "240x180"]),
    ("ref-ponytail", ["--style", "ponytail", "--strands", "6000", "--seed", "14"],
     ["--material", "black", "--camera", "0.25,0.1,0.35,0,0,0,30", "--size", "240x240"]),
    ("ref-wavy", ["--style", "wavy", "--strands", "10000", "--seed", "12"], ["--size", "320x240"]),
]
MOTIONS = [
    ("straight-shake", ["--style", "straight", "--strands", "800", "--seed", "1"], ["--preset", "straight", "--motion", "shake"]),
    ("curly-dance", ["--style", "curly", "--strands", "500", "--seed", "2"], ["--preset", "curly", "--motion", "dance"]),
    ("bob-nod", ["--style", "bob", "--strands", "800", "--seed", "3"], ["--preset", "hold-shape", "--motion", "nod"]),
    ("ponytail-turn", ["--style", "ponytail", "--strands", "800", "--seed", "4"], ["--preset", "straight", "--motion", "turn"]),
    ("wavy-jump", ["--style", "wavy", "--strands", "3000", "--seed", "5"], ["--preset", "wavy", "--motion", "jump"]),
]


def run(command):
    print("+", " ".join(map(str, command)), flush=True)
    subprocess.run([str(word) for word in command], check=True)


def measure(o, name, groom, options, more):
    """The sweep of a scene, measured or gone on with."""
    folder = o.work / name
    if not o.only_write:
        hair, head = o.work / f"{name}.hair", o.work / f"{name}-head.obj"
        run([o.program, "groom", *groom, "-o", hair, "--head-out", head])
        run([o.program, "tradeoff", hair, "--head", head, *options, *more, "--progress", "never", "-o", folder])
    return folder / "tradeoff.json"


def make_ladders(o):
    pictures = [measure(o, *scene, ["--only", "picture.together,truth.samples,picture.method", "--no-combine"]) for scene in PICTURES]
    motions = [measure(o, *scene, ["--only", "simulation.together", "--no-combine"]) for scene in MOTIONS]
    script, to = ROOT / "scripts/make-ladder.py", ROOT / "runtime/tradeoff"
    run(["python3", script, "picture", *pictures, to / "picture_ladder.json"])
    without = [w for p in ("detail", "chain.ftl_correction", "interaction.cell_m") for w in ("--without", f"simulation.{p}")]
    run(["python3", script, *without, "motion", *motions, to / "motion_ladder.json"])


# --- words ---------------------------------------------------------------------------------------------------------


def figure(x):
    """Three digits, no exponents where people would not write them."""
    if x == 0 or not math.isfinite(x):
        return f"{x:g}"
    return f"{x:.3g}" if 1e-3 <= abs(x) < 1e4 else f"{x:.2e}"


def good(diagram):
    return [r for r in diagram["rows"] if not r["failed"]]


def front(diagram):
    return sorted((r for r in good(diagram) if r["on_front"]), key=lambda r: r["time"]["median_ms"])


def row_of(diagram, name):
    return next((r for r in diagram["rows"] if r["id"] == name), None)


def settings(row):
    return "the program's own" if not row["settings"] else " ".join(f"`{s}`" for s in row["settings"])


def spans(rows):
    """Runs of a front that one knob's points, or one method's, make up: (name, first, last)."""
    def method(row):
        words = dict(s.split("=", 1) for s in row["settings"])
        return words.get("method") or ("density-map" if row["id"] == "default" else row["knob"].split(".")[0])
    runs = []
    for row in rows:
        name = method(row)
        if runs and runs[-1][0] == name:
            runs[-1][2] = row
        else:
            runs.append([name, row, row])
    return runs


def knob_table(diagram):
    slopes = {(s["knob"], s["against"] != "ms"): s for s in diagram["slopes"]}
    lines = []
    for curve in diagram["curves"]:
        rows = [r for r in good(diagram) if r["knob"] == curve["knob"]]
        if not rows:
            continue
        best, worst = min(rows, key=lambda r: r["error"]), max(rows, key=lambda r: r["error"])
        reach = worst["error"] / best["error"] if best["error"] > 0 else math.inf
        slope = slopes.get((curve["knob"], True))
        text = f"{slope['slope']:+.2f} ± {slope['standard_error'] or 0:.2f} per {slope['against']}" if slope else ""
        ms = [r["time"]["median_ms"] for r in rows]
        lines.append((reach, f"| {curve['knob']} | {figure(worst['error'])} ({worst['label']}) | {figure(best['error'])} ({best['label']}) "
                      f"| {figure(reach)}x | {figure(max(ms) / min(ms)) if min(ms) > 0 else ''}x | {text} |"))
    lines.sort(key=lambda line: -line[0])
    return ["| knob | most error | least error | error | time | slope |", "|---|---|---|---|---|---|"] + [text for _, text in lines]


def first_knob(diagram):
    """The knob whose points take most error away for the time they cost, from its cheapest to its best."""
    best = None
    for curve in diagram["curves"]:
        rows = [r for r in good(diagram) if r["knob"] == curve["knob"] and r["on_front"]]
        if len(rows) < 2:
            continue
        rows.sort(key=lambda r: r["time"]["median_ms"])
        gain = math.log(rows[0]["error"] / rows[-1]["error"]) if rows[-1]["error"] > 0 else 0
        if best is None or gain > best[0]:
            best = (gain, curve, rows)
    return best


def beyond_doubt(diagram, row):
    """A point that is better in error and time by more than both points' error bars and spreads leave open, or None."""
    for other in front(diagram):
        clear = 2 * math.hypot(other["error_bar"], row["error_bar"])
        if other["error"] + clear < row["error"] and other["time"]["max_ms"] < row["time"]["min_ms"]:
            return other
    return None


def say_default(diagram):
    row = row_of(diagram, "default")
    if row is None or row["failed"]:
        return "The program's own settings have no figures here."
    here = f"{figure(row['error'])} {diagram['error_unit']}".strip() + f" in {figure(row['time']['median_ms'])} ms"
    if row["on_front"]:
        return f"The program's own settings ({here}) are **on the front**."
    better = row_of(diagram, row["dominated_by"])
    if beyond_doubt(diagram, row) is None:
        return (f"The program's own settings ({here}) are **on the front as far as can be told**: no point is better in both by "
                f"more than error bars and spreads leave open; by the medians `{better['id']}` is ({figure(better['error'])} in "
                f"{figure(better['time']['median_ms'])} ms).")
    return (f"The program's own settings ({here}) are not on the front: `{better['id']}` has {figure(better['error'])} in "
            f"{figure(better['time']['median_ms'])} ms.")


def papers(diagrams):
    """Settings of papers: on how many fronts of how many scenes."""
    found = {}
    for d in diagrams:
        for r in good(d):
            if r["paper"]:
                found.setdefault((r["paper"], f"{r['knob']} = {r['label']}"), []).append(r["on_front"])
    return found


def write(o, sweeps):
    first = sweeps[0]
    origin = first["origin"]
    out = ["# What accuracy costs in time", "",
           "Written by `scripts/document-accuracy.py`, words and figures, from sweeps of `pelage tradeoff`"
           + (" `--quick`" if first["quick"] else "") + ". Do not edit.", "",
           f"Machine: {origin['cpu']}, {origin['threads']} threads, software OpenGL; program {origin['revision']}. "
           "Times are medians of repeated runs, warm; errors are against the truth that each section names, with error bars "
           "(motion's is a converged run of the same solver). Down and left is better; a point is on the front where no other is as fast and as "
           "accurate and better in one.", "", "Scenes:"]
    for s in sweeps:
        out.append(f"- **{s['name']}** (`{s['origin']['scene_hash']}`): `{s['command'].replace(str(o.work) + '/', '')}`")
    out += ["", "![the page of tradeoff](tradeoff.png)", ""]
    kinds = [d["id"] for d in first["diagrams"]]
    for kind in kinds:
        diagrams = [(s["name"], d) for s in sweeps for d in s["diagrams"] if d["id"] == kind]
        one = diagrams[0][1]
        unit = f" [{one['error_unit']}]" if one["error_unit"] else ""
        out += [f"## {one['title']}", "", f"Error: {one['error_name']}{unit}. Time: {one['time_name']}. {one['truth']}", ""]
        for name, d in diagrams:
            points = front(d)
            knob = first_knob(d)
            failed = [r for r in d["rows"] if r["failed"]]
            out += [f"### {name}", "", say_default(d)]
            if knob:
                _, curve, rows = knob
                out.append(f"Turn `{curve['knob']}` first: on the front from {figure(rows[0]['error'])} ({rows[0]['label']}, "
                           f"{figure(rows[0]['time']['median_ms'])} ms) to {figure(rows[-1]['error'])} ({rows[-1]['label']}, "
                           f"{figure(rows[-1]['time']['median_ms'])} ms).")
            runs = spans(points)
            if kind == "picture":
                out.append("By time: " + "; ".join(
                    f"{m} from {figure(a['time']['median_ms'])} ms ({figure(a['error'])}) to {figure(b['time']['median_ms'])} ms "
                    f"({figure(b['error'])})" for m, a, b in runs) + ".")
            if failed:
                out.append(f"{len(failed)} points failed: " + "; ".join(f"`{r['id']}` ({r['failed']})" for r in failed[:4]) + ".")
            out += ["", f"| on the front, of {len(good(d))} points | ms | {one['error_name']}{unit} | ± | settings |", "|---|---|---|---|---|"]
            for r in points:
                out.append(f"| {r['id']} | {figure(r['time']['median_ms'])} | {figure(r['error'])} | {figure(r['error_bar'])} | {settings(r)} |")
            out += ["", *knob_table(d), ""]
    out += ["## Settings of the papers", "",
            "What the papers print, at this project's other defaults, over all scenes above:", "",
            "| paper | setting | on the front |", "|---|---|---|"]
    for (paper, what), marks in sorted(papers([d for s in sweeps for d in s["diagrams"]]).items()):
        count = sum(marks)
        out.append(f"| {paper} | {what} | {'**never**' if count == 0 else f'{count} of {len(marks)}'} |")
    out += ["", "## Defaults", "", "| diagram | " + " | ".join(s["name"] for s in sweeps) + " |", "|---|" + "---|" * len(sweeps)]
    for kind in kinds:
        marks = []
        for s in sweeps:
            d = next((d for d in s["diagrams"] if d["id"] == kind), None)
            row = d and row_of(d, "default")
            marks.append("not swept" if row is None else "no figures" if row["failed"] else "on the front" if row["on_front"] else
                         "on it, within bars and spreads" if beyond_doubt(d, row) is None else f"behind {row['dominated_by']}")
        out.append(f"| {kind} | " + " | ".join(marks) + " |")
    (ROOT / "docs/accuracy.md").write_text("\n".join(out) + "\n")
    print("docs/accuracy.md")


def screenshot(page):
    browser = next((b for b in ("chromium-headless-shell", "chromium", "chromium-browser")
                    if subprocess.run(["which", b], capture_output=True).returncode == 0), None)
    if browser is None:
        print("no Chromium: docs/tradeoff.png is as it was")
        return
    run([browser, "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1280,1100",
         f"--screenshot={ROOT / 'docs/tradeoff.png'}", f"file://{page}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "build/release/bin/pelage")
    parser.add_argument("--work", type=Path, default=ROOT / "build/accuracy", help="sweeps are kept here")
    parser.add_argument("--quick", action="store_true", help="fewer values, smaller pictures")
    parser.add_argument("--ladders", action="store_true", help="measure the reference scenes of --budget-ms, too")
    parser.add_argument("--only-write", action="store_true", help="from sweeps that are there")
    o = parser.parse_args()
    o.work.mkdir(parents=True, exist_ok=True)
    o.work = o.work.resolve()
    os.environ["PELAGE_CACHE"] = str(o.work / "cache")
    if o.ladders:
        make_ladders(o)
    more = ["--quick"] if o.quick else []
    files = [file for file in (measure(o, *scene, more) for scene in SCENES) if file.exists()]
    write(o, [json.loads(f.read_text()) for f in files])
    screenshot((files[0].parent / "index.html").resolve())


if __name__ == "__main__":
    main()
