#!/bin/sh
# Makes the pictures of docs/lineage.md into docs/images/lineage/. Run from the repository's root:
#   sh docs/images/lineage.sh target/release/lahar
set -eu
lahar=${1:-target/release/lahar}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# picture SCENE FRAME SIZE: that frame of that scene.
picture() {
    "$lahar" run "$1" --frames "$2" --format png -o "$folder/$1" \
        --set "output.every=$2" --set "output.picture_size=$3" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
    cp "$folder/$1/images/$(printf %06d "$2").png" "docs/images/lineage/$1.png"
    echo "docs/images/lineage/$1.png"
}

square=[384,384]
picture mpm88 45 $square
picture mpm88-corrected 45 $square
picture mpm99 70 $square
picture mpm99-corrected 67 $square
picture mpm128 90 $square
picture mpm128-corrected 86 $square
picture mpm3d 45 $square
picture mpm3d-corrected 45 $square
picture mpm3d-64 90 $square
picture mpm3d-ggui-single-dam 60 [480,320]
picture mpm3d-ggui-double-dam 60 [480,320]
picture mpm3d-ggui-water-snow-jelly 60 [480,320]
picture mls-mpm88 75 $square
picture incremental-mpm-1 20 $square
picture incremental-mpm-2 16 $square
picture incremental-mpm-3 30 $square
picture incremental-mpm-3-corrected 30 $square
