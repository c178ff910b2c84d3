#!/usr/bin/env bash
# equal.sh JOBS [--quick]: builds the program without the network in six ways and compares what it
# prints, digest by digest. Exit 1 names the first line that differs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
jobs="$1"
quick="${2:-}"

rows=(
  "gcc-O3|g++|-O3"
  "gcc-O0|g++|-O0"
  "gcc-O3-avx2|g++|-O3 -march=x86-64-v3"
  "clang-O3|clang++-19|-O3"
  "clang-O0|clang++-19|-O0"
  "clang-O3-avx2|clang++-19|-O3 -march=x86-64-v3"
)
folder=build/equal
mkdir -p "$folder"

build_row() { # build_row NAME COMPILER FLAGS
  cmake -S . -B "$folder/$1" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER="$2" \
    -DCMAKE_CXX_FLAGS="$3" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
    -DCYCLOID_NETWORK=OFF -DCYCLOID_TESTS=OFF >"$folder/$1.log"
  cmake --build "$folder/$1" --parallel "$jobs" >>"$folder/$1.log" ||
    { tail -n 30 "$folder/$1.log" >&2; return 1; }
}

run_row() { # run_row NAME: every line is "scene tick digest"
  local program="$folder/$1/cycloid" scene
  "$program" run half-pipe --ticks 600 --digest-every 60 | sed 's/^/half-pipe /'
  if [[ "$quick" == --quick ]]; then
    # Between them they meet every kind of shape, joint and contact of space.
    for scene in vehicle-3d ragdolls-3d arch-3d top; do
      "$program" run "$scene" --ticks 120 --digest-every 1 | sed "s/^/$scene /"
    done
    return
  fi
  for scene in scenes/catalogue/*.json; do
    scene=$(basename "$scene" .json)
    "$program" run "$scene" --ticks 120 --digest-every 1 | sed "s/^/$scene /"
  done
}

printf '%-16s %8s %8s  %s\n' row seconds digests equal
status=0
for row in "${rows[@]}"; do
  IFS='|' read -r name compiler flags <<<"$row"
  start=$SECONDS
  build_row "$name" "$compiler" "$flags"
  run_row "$name" >"$folder/$name.digests"
  verdict=yes
  if ! cmp -s "$folder/gcc-O3.digests" "$folder/$name.digests"; then
    difference=$({ diff "$folder/gcc-O3.digests" "$folder/$name.digests" || true; } | sed -n 2p)
    verdict="NO: $difference"
    status=1
  fi
  printf '%-16s %8d %8d  %s\n' "$name" "$((SECONDS - start))" \
    "$(wc -l <"$folder/$name.digests")" "$verdict"
done
exit "$status"
