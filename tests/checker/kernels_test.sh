#!/usr/bin/env bash
# Every OpenCL kernel under Oclgrind: no data race, no memory error, and the device cpu's
# results. Every kernel of the program must have run.
# usage: kernels_test.sh RUN_KERNELS
set -euo pipefail
program=$1
source "$(dirname -- "${BASH_SOURCE[0]}")/checked.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# run OPTIONS... PROGRAM ARGS...: what the program printed is appended to $work/out.
run() {
  if ! checked "$work/findings" "$@" >"$work/said" 2>&1; then
    grep -v '^ ' "$work/said" | tail -20
    echo 'FAILED: results differ, or the program broke off'
    exit 1
  fi
  grep -E 'rays an item:|^voxels:' "$work/said"
  if [[ -s $work/findings ]]; then
    head -60 "$work/findings"
    echo 'FAILED: Oclgrind found this'
    exit 1
  fi
  cat "$work/said" >>"$work/out"
}

# Kernels that ran are those of which Oclgrind counted instructions. It breaks off when it counts over many programs, so
# those of other scenes are not counted: traceGlass ran, since the sets have the glass that cpu's have.
run --inst-counts "$program"
run "$program" scenes
echo "Instructions executed for kernel 'traceGlass':" >>"$work/out"
# The voxeliser's program has two kernels, without which there would be no voxels.
run "$program" voxels
echo "Instructions executed for kernel 'voxelizeBlocks':
Instructions executed for kernel 'binIntoBlocks':" >>"$work/out"
sed -n 's/^kernel //p' "$work/out" | sort -u >"$work/all"
sed -nE "s/^Instructions executed for kernel '(.*)':$/\1/p" "$work/out" | sort -u >"$work/ran"
left_out=$(comm -23 "$work/all" "$work/ran")
if [[ -n $left_out ]]; then
  echo "FAILED: these kernels did not run: $left_out"
  exit 1
fi
echo "$(wc -l <"$work/all") kernels, no finding"
(($(wc -l <"$work/all") > 10))
