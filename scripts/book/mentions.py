"""Whether the commands, options and settings that a text names are there. The guide's examples need files of the reader's own, so that they
cannot be run; this much of them can be held to the program."""

import re
import shlex

# A line in a fence of shell, or code within a line.
FENCE = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
INLINE = re.compile(r"`(voidwalk [^`]+)`")
SETTING = re.compile(r"--set\s+[\"']?([\w.]+)\s*=")
# Words in capitals stand for what the reader writes.
PLACEHOLDER = re.compile(r"[A-Z]+$")


def faults(pages, options, settings):
    """A line for each name that the program does not know: `options` by command, `settings` of a scene."""
    found = []
    for page, text in pages.items():
        named = [line for fence in FENCE.findall(text) for line in fence.split("\n")] + INLINE.findall(text)
        for line in named:
            found += [f"{page}: `{' '.join(line.split())}`: {fault}" for fault in of_command(line, options)]
        keys = [key for key in SETTING.findall(text) if key not in settings and not PLACEHOLDER.match(key)]
        found += [f"{page}: --set {key}: no such setting" for key in keys]
    return found


def of_command(line, options):
    """What is wrong with a command line of the program; nothing with that of another."""
    if not line.startswith("voidwalk "):
        return []
    words = shlex.split(line, comments=True)[1:]
    end = next((at for at, word in enumerate(words) if word in ("|", ">", "&&", ";", "&")), len(words))
    command, *rest = words[:end]
    if command.startswith("-") or PLACEHOLDER.match(command):
        return []
    if command not in options:
        return [f"no command {command}"]
    given = [word.split("=")[0] for word in rest if word.startswith("--")]
    return [f"{command} has no {option}" for option in given if option not in options[command]]
