# Read by scripts that need a headless Chromium and Python: installs Debian's packages for the commands that are missing.
#
#   . scripts/browser/chromium.sh; have_commands chromium python3

have_commands() {
    missing=
    for command in "$@"; do
        command -v "$command" >/dev/null 2>&1 && continue
        case $command in
            chromium) missing="$missing chromium fonts-liberation" ;;
            pdftotext) missing="$missing poppler-utils" ;;
            *) missing="$missing $command" ;;
        esac
    done
    [ -n "$missing" ] || return 0
    [ "$(id -u)" = 0 ] || { echo "needs:$missing (as root this script installs them)" >&2; exit 2; }
    apt-get update -qq >&2
    # shellcheck disable=SC2086 # several packages
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
}
