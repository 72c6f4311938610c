#!/usr/bin/env bash
# Every OpenCL kernel under Oclgrind: no data race, no memory error, and the device cpu's
# results. Every kernel of the program must have run.
# usage: kernels_test.sh RUN_KERNELS
set -euo pipefail
program=$1
source "$(dirname -- "${BASH_SOURCE[0]}")/checked.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Kernels that ran are those of which Oclgrind counted instructions.
if ! checked "$work/findings" --inst-counts "$program" >"$work/out" 2>&1; then
  grep -v '^ ' "$work/out" | tail -20
  echo 'FAILED: results differ, or the program broke off'
  exit 1
fi
grep 'rays an item:' "$work/out"
if [[ -s $work/findings ]]; then
  head -60 "$work/findings"
  echo 'FAILED: Oclgrind found this'
  exit 1
fi
sed -n 's/^kernel //p' "$work/out" | sort -u >"$work/all"
sed -nE "s/^Instructions executed for kernel '(.*)':$/\1/p" "$work/out" | sort -u >"$work/ran"
left_out=$(comm -23 "$work/all" "$work/ran")
if [[ -n $left_out ]]; then
  echo "FAILED: these kernels did not run: $left_out"
  exit 1
fi
echo "$(wc -l <"$work/all") kernels, no finding"
(($(wc -l <"$work/all") > 10))
