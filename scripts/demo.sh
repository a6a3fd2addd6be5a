#!/usr/bin/env bash
# From nothing to pictures: installs what is needed, builds, grows hair on a head, bakes a database for it and renders out
# of that database. Prints the paths of the pictures. Usage: scripts/demo.sh [output folder, default build/demo]
out=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/../build/demo}")
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
step() { printf '\n== demo: %s (%d min %02d s)\n' "$1" $((SECONDS / 60)) $((SECONDS % 60)); }

step "1 of 4: installing what is missing"
bash scripts/install-dependencies.sh build
step "2 of 4: building"
build_programs
bin=$build_root/release/bin
mkdir -p "$out"

step "3 of 4: one head of hair step by step, out of a database baked for it"
"$bin/pelage" groom --style wavy --strands 15000 --seed 1 -o "$out/wavy.hair" --head-out "$out/head.obj"
"$bin/pelage" cluster "$out/wavy.hair" -o "$out/wavy.json" --clusters 150 --plates 48
"$bin/pelage-bake" build --from "$out/wavy.json" --sectors 2000 -o "$out/wavy.hrir"
"$bin/pelage-bake" info "$out/wavy.hrir"
"$bin/pelage" render "$out/wavy.json" --database "$out/wavy.hrir" --head "$out/head.obj" --lighting portrait --size 720x720 \
  -o "$out/wavy.png" --stats

step "4 of 4: other hair with one command each, and the ray-traced truth"
for hair in "bob black" "curly red" "ponytail blond"; do
  read -r style material <<< "$hair"
  "$bin/pelage" groom --style "$style" --strands 15000 --seed 1 -o "$out/$style.hair"
  "$bin/pelage" render "$out/$style.hair" --head "$out/head.obj" --material "$material" --lighting portrait --colour-variation 0.5 \
    --size 720x720 -o "$out/$style.png"
done
"$bin/pelage" render "$out/wavy.hair" --head "$out/head.obj" --lighting portrait --size 720x720 -o "$out/wavy-strands.png"
"$bin/pelage" render "$out/wavy.hair" --head "$out/head.obj" --lighting portrait --method truth --size 720x720 \
  -o "$out/wavy-truth.png"
step "done"
printf 'Pictures:\n'
printf '  %s\n' "$out"/{wavy,bob,curly,ponytail,wavy-strands,wavy-truth}.png
