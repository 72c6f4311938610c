#!/usr/bin/env bash
# Runs every "sightline" command of the README's ```sh blocks, in order, in one folder that is empty but for the scene
# and cells of docs/, which they may read.
# usage: readme_test.sh PROGRAM README.md
set -euo pipefail
program=$(realpath "$1")
readme=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$program" "$work/bin/sightline"
export PATH="$work/bin:$PATH"
awk '/^```/ { inside = ($0 == "```sh"); next } inside' "$readme" >"$work/all"
# A command may go on in the next line after a backslash; what starts otherwise (build.sh) is tested elsewhere.
sed -e ':join' -e '/\\$/{N;s/\\\n//;b join' -e '}' "$work/all" | grep '^sightline ' >"$work/commands" || true
mkdir -p "$work/run/docs"
docs=$(dirname "$readme")
[[ $docs == */docs ]] || docs=$docs/docs
cp "$docs"/house.{obj,json} "$work/run/docs"
cd "$work/run"
count=0
while IFS= read -r command <&3; do
  printf '$ %s\n' "$command"
  bash -euo pipefail -c "$command" </dev/null || { echo "README: this command failed with exit code $?"; exit 1; }
  count=$((count + 1))
done 3<"$work/commands"
echo "$count commands of the README ran"
((count > 0))
