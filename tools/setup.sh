#!/bin/sh
# Finds a Python that is new enough and hands over to tools/setup.py, which does the rest.
# PYTHON=/path/to/python overrides the search.
set -eu
here=$(cd "$(dirname "$0")" && pwd)

new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1
}

if [ -n "${PYTHON:-}" ]; then
    if ! new_enough "$PYTHON"; then
        echo "setup: PYTHON=$PYTHON is not a working Python 3.11 or newer" >&2
        exit 2
    fi
    exec "$PYTHON" "$here/setup.py" "$@"
fi
for candidate in python3 python3.13 python3.12 python3.11; do
    if new_enough "$candidate"; then
        exec "$candidate" "$here/setup.py" "$@"
    fi
done
echo "setup: no Python 3.11 or newer found (looked for python3, python3.13, python3.12, python3.11);" \
    "install one (Debian 12, Ubuntu 24.04 or newer: sudo apt install python3 python3-venv)" \
    "or name one: make render PYTHON=/path/to/python3.12" >&2
exit 2
