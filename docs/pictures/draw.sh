#!/bin/sh
# Draws the pictures of README.md from a finished demo: docs/pictures/draw.sh [DEMO], with grouser on the path.
set -eu
demo=${1:-out/demo}
here=$(dirname "$0")
grouser render "$demo/run_a" --still 11 --size 1280x720 -o "$here"
mv "$here/still_11.000s.png" "$here/run_a.png"
grouser plot "$demo/run_a" --figure tension_map -o "$here/tension_map.png"
grouser plot "$demo/run_a" --figure tension_map --dark -o "$here/tension_map_dark.png"
