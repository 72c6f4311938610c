#!/usr/bin/env bash
# Oclgrind, called as for the program's kernels, sees a planted fault of each kind, and none where there is none.
# usage: faults_test.sh RUN_FAULTS
set -euo pipefail
program=$1
source "$(dirname -- "${BASH_SOURCE[0]}")/checked.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# expect KERNEL TEXT: the findings hold the text; without text, there are none.
expect() {
  checked "$work/$1" "$program" "$1"
  if [[ -z $2 && -s $work/$1 ]] || { [[ -n $2 ]] && ! grep -q -- "$2" "$work/$1"; }; then
    head -20 "$work/$1"
    echo "FAILED: $1: expected ${2:-no finding}"
    exit 1
  fi
}
expect clean ''
expect race 'data race'
expect outOfBounds 'Invalid write'
echo 'every fault was found'
