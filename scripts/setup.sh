#!/bin/sh
# What the Makefile needs around it. POSIX sh; python3 is the only other program assumed.
#   setup.sh system-run                       EGL, OpenGL and Mesa for offscreen pictures
#   setup.sh system-test                      the same, and Chromium for the browser tests
#   setup.sh system-soak                      an RTSP server, for `make soak-live`
#   setup.sh venv DIR REQUIREMENT [NAME==VERSION]   an environment with this project in it, as the
#                                             constraints pin it but for the one named
set -eu

python=${PYTHON:-python3}
# A machine's own pip settings may say where packages come from, not where they go or which.
unset PIP_TARGET PIP_PREFIX PIP_ROOT PIP_USER PIP_NO_DEPS PIP_CONSTRAINT PIP_REQUIREMENT \
    PIP_REQUIRE_VIRTUALENV PIP_REQUIRE_HASHES PIP_EDITABLE PIP_PRE PIP_UPGRADE PIP_DRY_RUN \
    PIP_QUIET PIP_BREAK_SYSTEM_PACKAGES PIP_PYTHON PIP_NO_BUILD_ISOLATION PIP_IGNORE_INSTALLED \
    PYTHONPATH PYTHONHOME PYTHONUSERBASE 2>/dev/null || true

say() { printf '%s\n' "$*" >&2; }

# Installs Debian packages that are missing. Fails where apt may not be used.
apt_install() {
    command -v apt-get >/dev/null 2>&1 || return 1
    if [ "$(id -u)" = 0 ]; then root=; elif sudo -n true 2>/dev/null; then root="sudo -n"; else return 1; fi
    say "Installing $* with apt ..."
    log=$(mktemp)
    if { $root apt-get update -qq &&
        $root env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y -qq --no-install-recommends "$@"; } >"$log" 2>&1; then
        rm -f "$log"
    else
        tail -n 5 "$log" >&2
        rm -f "$log"
        return 1
    fi
}

# Names of those packages that dpkg does not have.
missing() {
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
    done
}

has_opengl() {
    "$python" -c 'import ctypes; ctypes.CDLL("libEGL.so.1"); ctypes.CDLL("libGL.so.1")' 2>/dev/null
}

system_run() {
    if command -v dpkg-query >/dev/null 2>&1; then
        # PyOpenGL opens libGL by its name; EGL itself does without.
        lacking=$(missing libegl1 libgl1 libgl1-mesa-dri)
        # shellcheck disable=SC2086
        [ -z "$lacking" ] || apt_install $lacking ||
            say "Please install: $(echo $lacking) (apt-get install ...); without them the pictures are painted without OpenGL."
    else
        has_opengl || say "Please install EGL, OpenGL and Mesa's software renderer; without them the pictures are painted without OpenGL."
    fi
}

system_test() {
    system_run
    if ! command -v chromium >/dev/null 2>&1; then
        apt_install chromium fonts-dejavu-core fonts-liberation ||
            say "Please install: chromium (apt-get install chromium); without it the browser tests are skipped."
    fi
}

system_soak() {
    lacking=$(missing python3-gi gir1.2-gst-rtsp-server-1.0 gstreamer1.0-plugins-good \
        gstreamer1.0-plugins-ugly)
    # shellcheck disable=SC2086
    [ -z "$lacking" ] || apt_install $lacking ||
        say "Please install: $(echo $lacking) (apt-get install ...); without them RTSP is not tried."
}

need_python() {
    command -v "$python" >/dev/null 2>&1 || { say "Please install Python 3.10 or newer."; exit 1; }
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || {
        say "Python 3.10 or newer is needed, this is $("$python" -V 2>&1); set PYTHON=... to another one."
        exit 1
    }
    "$python" -c 'import venv, ensurepip' 2>/dev/null && return
    apt_install python3-venv && "$python" -c 'import venv, ensurepip' 2>/dev/null || {
        say "Please install: python3-venv (apt-get install python3-venv); $python cannot make environments."
        exit 1
    }
}

# Writes NAME==VERSION into the file $pins, in place of what it says of that name.
pin() {
    others=$(grep -v "^${1%%==*}==" "$pins")
    printf '%s\n' "$others" "$1" >"$pins"
}

make_venv() {
    directory=$1 requirement=$2 instead=${3:-}
    need_python
    # A half-made environment, or one of a Python that is gone, is made anew.
    if ! "$directory/bin/python" -m pip --version >/dev/null 2>&1; then
        "$python" -m venv --clear "$directory"
    fi
    say "Installing into $directory (the first time takes a minute or two) ..."
    pins=$(mktemp)
    trap 'rm -f "$pins"' EXIT
    cat constraints.txt >"$pins"
    if "$directory/bin/python" -c 'import sys; sys.exit(sys.version_info < (3, 14))'; then
        for newer in $(grep -v '^#' constraints-3.14.txt); do pin "$newer"; done
    fi
    [ -z "$instead" ] || pin "$instead"
    "$directory/bin/python" -m pip install --quiet --disable-pip-version-check --no-input \
        -c "$pins" "$requirement"
}

case "${1:-}" in
system-run) system_run ;;
system-test) system_test ;;
system-soak) system_soak ;;
venv) make_venv "$2" "$3" "${4:-}" ;;
*)
    say "usage: setup.sh system-run | system-test | system-soak | venv DIR REQUIREMENT [NAME==VERSION]"
    exit 2
    ;;
esac
