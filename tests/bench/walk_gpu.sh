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
# False pixels at odd sizes, a walk each.
for size in 1x1 97x61 640x360 1000x1000 1279x719 1920x1080 333x777; do
  "$program" walk "$name.glb" --path "$name-walk.json" --resolution "$size" --repeats 1 --trace-every 0 --max-false 0 \
    --methods none,vfc,stop-and-wait,chc,chc++,opti-chc++,hiz,hiz-meshlets,boxes || echo "$name, $size: exit code $?"
done
