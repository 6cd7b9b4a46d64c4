#!/usr/bin/env bash
# The makers' own clients, unmodified, against simulated devices. They are installed from PyPI into an environment of
# their own below target/. In CI they must be there; elsewhere the sessions are skipped where they cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

environment=target/clients
python=$environment/bin/python
install() {
    [ -x "$python" ] || python3 -m venv "$environment"
    "$python" -m pip install --quiet --disable-pip-version-check --requirement tests/clients/requirements.txt
}
if ! install; then
    [ -z "${CI:-}" ] || { echo "the clients cannot be installed" >&2; exit 1; }
    echo "SKIPPED: sessions of the makers' clients, which cannot be installed here"
    exit 0
fi
cargo build --locked --quiet --bin dhc
for session in tests/clients/dynamixel.py tests/clients/mycobot.py; do
    echo "$session"
    "$python" "$session" "${CARGO_TARGET_DIR:-target}/debug/dhc"
done
