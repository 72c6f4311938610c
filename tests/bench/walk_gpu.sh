#!/usr/bin/env bash
# The four generated scenes along their walks, by all methods, on a GPU: reports, CSV and pages into a folder.
# usage: walk_gpu.sh PROGRAM FOLDER [SCENE:TRIANGLES...]
set -euo pipefail
program=$(realpath "$1")
mkdir -p "$2"
cd "$2"
shift 2
(($# > 0)) || set -- city:3670000 city:12000000 plant:12700000 bistro:5660000 canyon:2240000
frames=${SIGHTLINE_WALK_FRAMES:-1000}
for wanted in "$@"; do
  scene=${wanted%:*} triangles=${wanted#*:} name=${wanted/:/-}
  "$program" scene "$scene" -o "$name.glb" --triangles "$triangles" --walk "$name-walk.json" --frames "$frames" --overwrite
  "$program" cells "$name.glb" -o "$name-cells.json" --walk "$name-walk.json" --length 25 --overwrite
  "$program" bake "$name.glb" --cells "$name-cells.json" -o "$name.pvs" --device opencl --overwrite \
    --max-seconds "${SIGHTLINE_WALK_CELL_SECONDS:-1}" --validation-rays 0
  for in_flight in 1 2; do
    "$program" walk "$name.glb" --path "$name-walk.json" --pvs "$name.pvs" --device vulkan --in-flight "$in_flight" \
      --trace-device opencl --max-false 0 --pictures "$name-pictures" --report "$name-$in_flight.json" \
      --csv "$name-$in_flight.csv" --html "$name-$in_flight.html" || echo "$name: exit code $?"
  done
done
# One large cell of a street against the small ones in it, each drawn by its own set.
"$program" cells "$name.glb" -o "$name-large.json" --walk "$name-walk.json" --length 100 --overwrite
small=$(python3 - "$name-cells.json" "$name-large.json" "$name-street.json" <<'END'
import json, sys
small, large = (json.load(open(file))["cells"] for file in sys.argv[1:3])
one = dict(max(large, key=lambda cell: max(cell["size"])), name="large")
inside = [cell for cell in small if all(abs(a - b) <= s / 2 + 1e-3 for a, b, s in
                                        zip(cell["center"], one["center"], one["size"]))][:4]
json.dump({"cells": [one] + inside}, open(sys.argv[3], "w"))
print(",".join(cell["name"] for cell in inside))
END
)
"$program" bake "$name.glb" --cells "$name-street.json" -o "$name-street.pvs" --device opencl --overwrite \
  --max-seconds "${SIGHTLINE_WALK_STREET_SECONDS:-20}" --validation-rays 0
"$program" walk "$name.glb" --path "views:large,$small" --views 60 --pvs "$name-street.pvs" --device vulkan \
  --methods none,vfc,hiz,pvs,pvs+vfc,pvs+hiz --trace-every 0 --report "$name-street-report.json" --html "$name-street.html"
# What the chain of submits is worth.
for chain in barriers semaphores; do
  "$program" walk "$name.glb" --path "$name-walk.json" --methods chc,chc++,opti-chc++ --chain "$chain" --check none
done
# False pixels at odd sizes, a walk each.
for size in 1x1 97x61 640x360 1000x1000 1279x719 1920x1080 333x777; do
  "$program" walk "$name.glb" --path "$name-walk.json" --resolution "$size" --repeats 1 --trace-every 0 --max-false 0 \
    --methods none,vfc,stop-and-wait,chc,chc++,opti-chc++,hiz,hiz-meshlets,boxes || echo "$name, $size: exit code $?"
done
