#!/usr/bin/env bash
# build.sh without a Debian package to install from: apt-get, dpkg-query, sudo and cmake are replaced.
# usage: build_sh_test.sh SOURCE_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
folder="$work/a folder with blanks"
mkdir -p "$folder" "$work/bin" "$work/home" "$work/elsewhere"
cp "$1/build.sh" "$folder/"

fake() {  # NAME: a command that runs the script on standard input
  { printf '#!/bin/sh\n'; cat; } >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}

failures=0
# expect EXIT_CODE PATTERN ARGS...: from another folder, without standard input, in an empty environment.
expect() {
  local code=$1 pattern=$2 got=0 output
  shift 2
  output=$(cd "$work/elsewhere" &&
    env -i HOME="$work/home" PATH="$work/bin:/usr/bin:/bin" "$folder/build.sh" "$@" 2>&1 <&-) || got=$?
  if [[ $got == "$code" && $output == *$pattern* ]]; then return; fi
  printf 'build.sh %s: expected exit code %s and "%s", got %s and:\n%s\n' "$*" "$code" "$pattern" "$got" "$output"
  failures=$((failures + 1))
}

expect 2 "usage: ./build.sh demo"
expect 2 "usage: ./build.sh demo" install
expect 2 "usage: ./build.sh demo" demo --large
expect 0 "usage: ./build.sh demo" --help

# shellcheck disable=SC2016  # the fakes expand their own variables
fake sudo <<<'exec "$@"'
fake dpkg-query <<<'case "$*" in *libpng-dev*|*cmake*) exit 1 ;; esac; echo installed'
# shellcheck disable=SC2016
fake apt-get <<<'echo "apt-get $*" >>"$HOME/apt"; echo "E: no network"; exit 100'
expect 1 "apt-get install --no-install-recommends cmake libpng-dev" test
expect 1 "E: no network" demo --small
grep -q update "$work/home/apt" || { echo "apt-get update was not tried"; failures=$((failures + 1)); }

# Vulkan's driver comes from the backports of the mirror that the sources name, in both formats of sources; only
# for the tests, and only where the installed one is too old.
mkdir -p "$work/apt/sources.list.d"
# shellcheck disable=SC2016
fake apt-config <<<'echo "sourceparts=$HOME/../apt/sources.list.d/; sourcelist=$HOME/../apt/sources.list"'
# shellcheck disable=SC2016
fake dpkg-query <<<'case "$*" in *Version*mesa*) echo 22.3.6-1+deb12u1 ;; *) echo installed ;; esac'
expectBackports() {  # FILE TEXT: build.sh test writes the file for apt-get and asks for the package
  [[ $(grep -s '^VERSION_CODENAME=' /etc/os-release) == *bookworm* ]] || return 0
  rm -f "$work/home/apt"
  expect 1 "E: no network" test
  local written="$folder/build/apt-sources/$1"
  if [[ ! -f $written || $(<"$written") != "$2" ]]; then
    printf '%s: expected\n%s\ngot\n%s\n' "$written" "$2" "$(cat "$written" 2>&1)"
    failures=$((failures + 1))
  fi
  grep -q "SourceParts=$folder/build/apt-sources update" "$work/home/apt" ||
    { echo "apt-get update without the backports"; failures=$((failures + 1)); }
}
printf '%s\n' '# no deb http://other.example/ bookworm main' 'deb http://security.example/ bookworm-security main' \
  'deb [signed-by=/a.gpg arch=amd64] http://mirror.example/debian bookworm main contrib' >"$work/apt/sources.list"
expectBackports sightline-backports.list \
  'deb [signed-by=/a.gpg arch=amd64] http://mirror.example/debian bookworm-backports main'
printf '%s\n' 'Types: deb' 'URIs: http://security.example/' 'Suites: bookworm-security' 'Components: main' '' \
  'Types: deb deb-src' '# ours' 'URIs: http://mirror.example/debian' 'Suites: bookworm bookworm-updates' \
  'Components: main contrib' 'Signed-By: /a.gpg' >"$work/apt/sources.list.d/debian.sources"
expectBackports sightline-backports.sources 'Types: deb
# ours
URIs: http://mirror.example/debian
Suites: bookworm-backports
Components: main
Signed-By: /a.gpg'
rm -f "$work/home/apt"
fake cmake <<<'echo "cmake $*"; exit 1'
expect 1 "cmake could not configure" demo
[[ ! -e $work/home/apt ]] || { echo "the demo asked for what only the tests need"; failures=$((failures + 1)); }

# Nothing missing: no apt-get at all, and the build goes on.
rm -f "$work/home/apt"
fake dpkg-query <<<'echo installed'
fake cmake <<<'echo "cmake $*"; exit 1'
expect 1 "cmake could not configure" test
[[ ! -e $work/home/apt ]] || { echo "apt-get ran with nothing missing"; failures=$((failures + 1)); }

exit $((failures > 0))
