#!/usr/bin/env bash
# Makes the film and the pictures of README.md anew. In the folder of the repository, after `cargo build --release`:
#
#   docs/images/make.sh
#
# LAHAR names another binary. Some three minutes on two cores. The window's pictures are made by
# crates/lahar-app/tests/window.sh.
set -euo pipefail

lahar=${LAHAR:-target/release/lahar}
images=$(cd "$(dirname "$0")" && pwd)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# picture SCENE FRAME: what the scene looks like at this frame.
picture() {
    "$lahar" run "$1" --isa portable --frames "$2" --format png \
        --set output.every="$2" --set "output.picture_size=[480,320]" -o "$out/$1" > "$out/log" 2>&1 || { cat "$out/log"; exit 1; }
    cp "$out/$1/images/$(printf %06d "$2").png" "$images/$1.png"
    echo "$1.png"
}

"$lahar" run dam-break --isa portable --format gif -o "$out/film" > "$out/log" 2>&1 || { cat "$out/log"; exit 1; }
cp "$out/film/video.gif" "$images/dam-break.gif"
echo dam-break.gif

picture dam-break-3d 36
picture water-jelly-snow 24
picture obstacle 45
picture jelly-letters 34
picture gears 60
picture snow-castle 16
picture snowballs 16
picture honey 20
picture planet 40
picture galaxy 140
picture knot-3d 24
picture drops-3d 52
