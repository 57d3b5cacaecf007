"""Runs the commands that a page shows, and holds the page to what they print.

A page is Markdown. In a fence ```console a line that begins with `$ ` is a command, and what follows is what it prints: errors and
warnings first, then the rest, without progress. `...` by itself stands for any lines, `[..]` for anything within a line, and times are not
compared; the page shows what was printed, or what it says itself where that has `...`. ```console exit=2 says how the commands end,
```console in=checkout that they run at the top of the repository, where they change nothing. A fence with `file=NAME` is written to that file
first, one with `append=NAME` is added to it. An image or link to `run:PATH` is a file that the commands left.
"""

import difflib
import os
import pathlib
import re
import shutil
import subprocess

FENCE = re.compile(r"^```([\w-]*)(.*)$")
# Lines that are there or not, by how fast the machine is.
PROGRESS = re.compile(r" gone,|^after .* not yet final: |^ *\d+\.\d s  |^packing .* steps$| \d+ of \d+ runs$")
TIME = re.compile(r"\b\d+(?:\.\d+)? (?:s|min|h)\b")
# Of the machine, too.
MEMORY = re.compile(r"\b\d+(?:\.\d+)? [kMGT]B\b")
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# A command that hangs must not hang the build.
LONGEST = 600


class Stale(Exception):
    """A page that says what is not so."""


def page(text, name, folder, binary, assets, update=False):
    """The page with what its commands printed, and as it should be written where that differs from what it says.

    The commands run in `folder`; files that the page shows are copied to `assets`.
    """
    shown, written, lines = [], [], text.split("\n")
    at = 0
    while at < len(lines):
        fence = FENCE.match(lines[at])
        if not fence:
            shown.append(lines[at])
            written.append(lines[at])
            at += 1
            continue
        end = next((n for n in range(at + 1, len(lines)) if lines[n].startswith("```")), None)
        if end is None:
            raise Stale(f"{name}, line {at + 1}: a fence that does not end")
        body, options = lines[at + 1:end], dict(re.findall(r"(\w+)=(\S+)", fence[2]))
        if fence[1] == "console":
            place = ROOT if options.get("in") == "checkout" else folder
            body, kept = session(body, f"{name}, line {at + 1}", place, binary, int(options.get("exit", 0)), update)
        else:
            kept = body
        if "file" in options:
            (folder / options["file"]).write_text("\n".join(body) + "\n")
            shown.append(f"`{options['file']}`:\n")
        if "append" in options:
            with open(folder / options["append"], "a") as file:
                file.write("\n".join(["", *body, ""]))
        shown += ["```" + fence[1], *body, "```"]
        written += [lines[at], *kept, "```"]
        at = end + 1
    return take_files("\n".join(shown), name, folder, assets), "\n".join(written)


def session(body, where, folder, binary, exit_code, update):
    """Runs the commands of a fence: what they printed, and the fence as it should be written."""
    shown, written = [], []
    for command, expected in commands(body, where):
        printed = run(command, where, folder, binary, exit_code)
        if not matches(printed, expected):
            if not update:
                raise Stale(difference(where, command, printed, expected))
            expected = printed
        shown += ["$ " + command, *(expected if "..." in expected else printed)]
        written += ["$ " + command, *expected]
    return shown, written


def commands(body, where):
    """The commands of a fence, each with the lines that follow."""
    found = []
    for line in body:
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif found:
            found[-1][1].append(line)
        else:
            raise Stale(f"{where}: `{line}` before any command")
    return found


def run(command, where, folder, binary, exit_code):
    """The lines that a command prints."""
    environment = {"PATH": f"{binary.parent}:{os.environ['PATH']}", "HOME": str(folder), "LC_ALL": "C.UTF-8", "COLUMNS": "100",
                   "REPOSITORY": str(ROOT)}
    try:
        done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        raise Stale(f"{where}: `{command}` did not end in {LONGEST} s") from None
    said = [line for line in done.stderr.splitlines() if not PROGRESS.search(line)]
    if done.returncode != exit_code:
        raise Stale("\n".join([f"{where}: `{command}` ended with {done.returncode}, not {exit_code}", *said]))
    return [line.rstrip() for line in said + done.stdout.splitlines()]


def matches(printed, expected):
    """Whether the lines are those that were expected."""
    if not expected:
        return not printed
    if expected[0] == "...":
        return matches(printed, expected[1:]) or (bool(printed) and matches(printed[1:], expected))
    return bool(printed) and same(printed[0], expected[0]) and matches(printed[1:], expected[1:])


def same(printed, expected):
    parts = [re.escape(of_any_machine(part)) for part in expected.split("[..]")]
    return re.fullmatch(".*".join(parts), of_any_machine(printed)) is not None


def of_any_machine(line):
    return MEMORY.sub("<memory>", TIME.sub("<time>", line))


def difference(where, command, printed, expected):
    """What a person needs to see what changed: `-` is what the page says, `+` what was printed."""
    changes = difflib.unified_diff([*map(of_any_machine, expected)], [*map(of_any_machine, printed)], n=0, lineterm="")
    lines = [f"  {line}" for line in changes if not line.startswith(("---", "+++", "@@"))]
    return "\n".join([f"{where}: `{command}` prints something else:", *lines])


def take_files(text, name, folder, assets):
    """Copies the files that a page shows, and points it there."""
    def taken(match):
        source = folder / match[1]
        if not source.is_file():
            raise Stale(f"{name}: no command left {match[1]}")
        target = assets / pathlib.Path(name).stem / match[1].replace("/", "-")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
        return f"]({assets.name}/{target.parent.name}/{target.name})"

    return re.sub(r"\]\(run:([^)]+)\)", taken, text)
