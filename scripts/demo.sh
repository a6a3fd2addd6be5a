#!/usr/bin/env bash
# From nothing to pictures: installs what is needed, builds, grows hair on a head, bakes a database for it and renders out
# of that database. Prints the paths of the pictures. Usage: scripts/demo.sh [output folder, default build/demo]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/demo}

bash scripts/install-dependencies.sh
cmake --preset release -DPELAGE_BUILD_TESTS=OFF -DPELAGE_BUILD_BENCHMARKS=OFF >/dev/null
cmake --build --preset release --target pelage pelage-bake
bin=build/release/bin
mkdir -p "$out"

# A head with four hairstyles; the first out of a database that is baked by hand, step by step.
"$bin/pelage" groom --style wavy --strands 15000 --seed 1 -o "$out/wavy.hair" --head-out "$out/head.obj"
"$bin/pelage" cluster "$out/wavy.hair" -o "$out/wavy.json" --clusters 150 --plates 48
"$bin/pelage-bake" build --from "$out/wavy.json" --sectors 2000 -o "$out/wavy.hrir"
"$bin/pelage-bake" info "$out/wavy.hrir"
"$bin/pelage" render "$out/wavy.json" --database "$out/wavy.hrir" --head "$out/head.obj" --size 960x720 -o "$out/wavy.png" --stats

# The others with one command each: clusters are fitted, and a database is baked and cached, on the way.
materials=(black red blond)
styles=(bob curly ponytail)
plates=(24 80 24)  # curls need more
for i in 0 1 2; do
  "$bin/pelage" groom --style "${styles[i]}" --strands 15000 --seed 1 -o "$out/${styles[i]}.hair"
  "$bin/pelage" render "$out/${styles[i]}.hair" --head "$out/head.obj" --material "${materials[i]}" --plates "${plates[i]}" \
    --size 960x720 -o "$out/${styles[i]}.png"
done
# The same hair strand by strand, shadowed by a density map, and the ray-traced truth.
"$bin/pelage" render "$out/wavy.hair" --head "$out/head.obj" --method density-map --size 960x720 -o "$out/wavy-strands.png"
"$bin/pelage" render "$out/wavy.hair" --head "$out/head.obj" --method truth --size 960x720 -o "$out/wavy-truth.png"
echo "Pictures: $out/wavy.png $out/bob.png $out/curly.png $out/ponytail.png $out/wavy-strands.png $out/wavy-truth.png"
