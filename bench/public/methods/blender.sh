#!/bin/sh
# Blender's modifier Data Transfer: npm run bench:public -- --method bench/public/methods/blender.sh
blender --background --python "$(dirname "$0")/blender.py" | grep --line-buffered '^{' # it says its version first
