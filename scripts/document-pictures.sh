#!/usr/bin/env bash
# Makes every picture of docs/ but tradeoff.png anew, with the release build that scripts/demo.sh leaves behind.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=build/release/bin
work=$(mktemp -d)
mkdir -p docs
trap 'rm -rf "$work"' EXIT
render() { "$bin/pelage" render "$@" --head "$work/head.obj" --size 480x480 --log-level warn; }

# The first pictures that anyone sees: strand by strand, in portrait light.
for hair in "wavy brown" "bob black" "curly red" "ponytail blond"; do
  read -r style material <<<"$hair"
  "$bin/pelage" groom --style "$style" --strands 30000 --seed 1 -o "$work/$style.hair" --head-out "$work/head.obj" --log-level warn
  "$bin/pelage" render "$work/$style.hair" --head "$work/head.obj" --material "$material" --lighting portrait --colour-variation 0.5 \
    --size 1000x1000 -o "docs/$style.png" --progress never --log-level warn
done
for style in wavy bob; do
  "$bin/pelage" groom --style "$style" --strands 15000 --seed 1 -o "$work/$style.hair" --head-out "$work/head.obj" --log-level warn
done
# What the rungs of the accuracy ladder and the effects look like, on the bob.
render "$work/bob.hair" --records direct -o docs/bob-direct.png
render "$work/bob.hair" --records own-alpha -o docs/bob-own-alpha.png
render "$work/bob.hair" --records database -o docs/bob-database.png
render "$work/bob.hair" --records database --self-shadow none --off global-shadow -o docs/bob-unshadowed.png

# Figures of the papers: shadows strand by strand against the truth, and what shades a strand.
for figure in resolutions self-shadow filter lobes; do
  "$bin/pelage" figure "$figure" --size 300x340 -o "docs/$figure.png" --progress never --log-level warn
done

# What the effects of SATF do, against the truth.
for figure in ablations head; do
  "$bin/pelage" figure "$figure" --size 300x340 -o "docs/$figure.png" --progress never --log-level warn
done

# The page of `pelage compare`, as a browser shows its beginning.
"$bin/pelage" compare "$work/bob.hair" --head "$work/head.obj" --material blond --size 420x420 -o "$work/compared" \
  --progress never --log-level warn > /dev/null
chromium-headless-shell --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,1180 \
  --screenshot="$PWD/docs/compare.png" "file://$work/compared/index.html" 2> /dev/null

# Moving hair.
for figure in motion presets; do
  "$bin/pelage" figure "$figure" --size 260x300 -o "docs/$figure.png" --progress never --log-level warn
done

# Records and coverage: a generic database against the wavy hair.
"$bin/pelage" cluster "$work/wavy.hair" -o "$work/wavy.json" --log-level warn > /dev/null
"$bin/pelage-bake" build -o "$work/random.hrir" --progress never > /dev/null
"$bin/pelage" info "$work/random.hrir" --against "$work/wavy.json" -o docs/coverage.png > /dev/null
