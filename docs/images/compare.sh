#!/usr/bin/env bash
# Makes docs/images/compare/: what transfer schemes and forces do to a spinning jelly and a splash.
# Usage: docs/images/compare.sh [PROGRAM], PROGRAM being a release build of lahar. Takes a minute.
set -euo pipefail
cd "$(dirname "$0")"
program=$(realpath "${1:-../../target/release/lahar}")
here=$PWD
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
mkdir -p "$here/compare"

"$program" run spinning-jelly --compare transfer=pic,flip,apic -o jelly >/dev/null
cp jelly/plots/angular-momentum.svg "$here/compare/jelly-angular-momentum.svg"
cp jelly/plots/energy.svg "$here/compare/jelly-energy.svg"

"$program" run spinning-jelly --compare force=mls,classic -o jelly-force >/dev/null
cp jelly-force/plots/energy.svg "$here/compare/jelly-force-energy.svg"

"$program" run dam-break --compare transfer=pic,flip,apic -o splash >/dev/null
cp splash/plots/energy.svg "$here/compare/splash-energy.svg"
cp splash/images/000054.png "$here/compare/splash.png"

"$program" run dam-break --compare force=mls,classic -o splash-force >/dev/null
cp splash-force/images/000054.png "$here/compare/splash-force.png"
