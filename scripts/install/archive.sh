#!/usr/bin/env bash
# One archive of the program for one system, with its checksum: the binary, its completions and manual pages, the texts that
# belong to it, and the licences of the crates in it, which cargo and Python 3 gather.
#
#     scripts/install/archive.sh target/dist/voidwalk voidwalk-0.1.0-x86_64-unknown-linux-gnu [FOLDER]
#
# The binary is run here, to write its completions and manual pages. FOLDER (archives) gets NAME.tar.gz, or NAME.zip for a
# binary .exe, and the same with .sha256. The same tree and binary give the same bytes.
set -euo pipefail
binary=$(realpath "$1")
name=$2
folder=${3:-archives}
mkdir -p "$folder"
folder=$(realpath "$folder")
cd "$(dirname "$0")/../.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
to=$work/$name
mkdir -p "$to/completions"
cp "$binary" README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT "$to"
python=$(command -v python3 || command -v python)
"$python" scripts/install/third_party.py "$to/LICENSES-THIRD-PARTY.txt"
"$binary" man "$to/man" >/dev/null
"$binary" completions bash >"$to/completions/voidwalk.bash"
"$binary" completions elvish >"$to/completions/voidwalk.elv"
"$binary" completions fish >"$to/completions/voidwalk.fish"
"$binary" completions powershell >"$to/completions/_voidwalk.ps1"
"$binary" completions zsh >"$to/completions/_voidwalk"

# Python packs: it is on every runner, and tar and zip differ between systems.
"$python" - "$work" "$name" "$folder" "$binary" <<'END'
import gzip
import hashlib
import sys
import tarfile
import zipfile
from pathlib import Path

work, name, folder, binary = sys.argv[1:]
files = sorted(path for path in Path(work, name).rglob("*") if path.is_file())


def is_program(path):
    return path.name == Path(binary).name


if binary.endswith(".exe"):
    archive = Path(folder, f"{name}.zip")
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for path in files:
            out.writestr(zipfile.ZipInfo(path.relative_to(work).as_posix()), path.read_bytes(), zipfile.ZIP_DEFLATED)
else:
    archive = Path(folder, f"{name}.tar.gz")
    with open(archive, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        with tarfile.open(fileobj=packed, mode="w") as out:
            for path in files:
                entry = tarfile.TarInfo(path.relative_to(work).as_posix())
                entry.size, entry.mode = path.stat().st_size, 0o755 if is_program(path) else 0o644
                with open(path, "rb") as content:
                    out.addfile(entry, content)
digest = hashlib.sha256(archive.read_bytes()).hexdigest()
archive.with_name(archive.name + ".sha256").write_bytes(f"{digest}  {archive.name}\n".encode())
print(f"{archive.name}: {archive.stat().st_size:,} bytes, {len(files)} files")
END
