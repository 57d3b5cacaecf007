"""Pages that the program writes of itself: one a command, from its long help, and every setting of a scene, from its schema."""

import json
import os
import re
import subprocess


def ask(binary, *arguments):
    """What the program prints on paper of one width."""
    done = subprocess.run([binary, *arguments], capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "100"})
    return done.stdout


def commands(binary):
    """The names of the commands, in the order of the help."""
    text = ask(binary, "--help")
    groups = text.split("\nOptions:\n", 1)[0]
    more = re.search(r"^More commands: (.*)$", groups, re.M)
    return re.findall(r"^  ([a-z]+)  ", groups, re.M) + more[1].split(", ")


def command_page(binary, name):
    """What a command does, and its page."""
    about, usage, sections = parts_of_help(ask(binary, name, "--help"), name)
    page = [f"# voidwalk {name}", "", escaped(about), "", "```text", usage, "```", ""]
    for title, lines in sections:
        page += [f"## {title}", ""]
        entries = entries_of(lines)
        if entries is None:
            page += ["```text", *unindented(lines), "```", ""]
            continue
        for term, words in entries:
            page += [f"`{term}`", f": {escaped(words) or '(no words)'}", ""]
    return escaped(about), "\n".join(page)


def options(binary, name):
    """The long names of a command's options."""
    _, _, sections = parts_of_help(ask(binary, name, "--help"), name)
    terms = [term for _, lines in sections for term, _ in entries_of(lines) or []]
    return {option for term in terms for option in re.findall(r"--[\w-]+", term)}


def settings(binary):
    """The names of a scene's settings."""
    sections = json.loads(ask(binary, "init", "--json"))["sections"]
    return {setting["name"] for section in sections for setting in section["settings"]}


def parts_of_help(text, name):
    """What it does, how it is called, and the sections below."""
    about, rest = text.split("\nUsage: ", 1)
    usage, *rest = rest.split("\n\n", 1)
    sections = []
    for line in "".join(rest).split("\n"):
        if re.match(r"\S.*:$", line):
            sections.append((line[:-1], []))
        elif sections:
            sections[-1][1].append(line)
        elif line.strip():
            raise SystemExit(f"voidwalk {name} --help: `{line}` stands in no section")
    return joined(about.split("\n")), joined(usage.split("\n")), sections


def entries_of(lines):
    """Arguments or options with their words; none where the section is something else, as examples are.

    A term stands at the left, its words two spaces after it or below it further to the right.
    """
    entries, left = [], None
    for line in filter(str.strip, lines):
        indent = len(line) - len(line.lstrip())
        is_term = re.match(r"\s{2,6}(-|<|\[)", line) and indent <= 6
        if is_term:
            term, _, words = line.strip().partition("  ")
            entries.append([term, [words.strip()]])
            left = indent
        elif entries and indent > left:
            entries[-1][1].append(line.strip())
        else:
            return None
    return [(term, joined(words)) for term, words in entries]


def unindented(lines):
    while lines and not lines[-1].strip():
        lines = lines[:-1]
    least = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return [line[least:] for line in lines]


def joined(lines):
    return " ".join(line.strip() for line in lines if line.strip())


def escaped(words):
    """Words of plain text in Markdown."""
    return re.sub(r"([\\`*_<>|\[\]])", r"\\\1", words)


def marked(words):
    """Words of the schema, which are Markdown but for what looks like a tag or a link."""
    return re.sub(r"([<>|\[\]])", r"\\\1", words)


def scene_page(binary):
    """Every setting of a scene."""
    scene = json.loads(ask(binary, "init", "--json"))
    page = ["# The scene, setting by setting", "",
            "`voidwalk init my.toml` writes the built-in scene with all of these. `--set NAME=VALUE` gives one on the command line. "
            "Sizes are diameters. A default of *none* means that the setting is not there unless it is given. "
            "`voidwalk init --json` prints this page for programs.", ""]
    for section in scene["sections"]:
        page += [f"## {'[' + section['name'] + ']' if section['name'] else 'At the top'}", "", marked(section["about"]), ""]
        for setting in section["settings"]:
            page += setting_lines(setting)
    page += ["## Settings that exclude each other", "",
             "A scene may use one of each line. On the command line the one that is set replaces the others.", ""]
    for group in scene["exclusive"]:
        ways = " *or* ".join(way_words(way) for way in group["alternatives"])
        page.append(f"- To {group['says']}: {ways}.")
    return "\n".join(page) + "\n"


def setting_lines(setting):
    def value(text):
        return "none" if text is None else f"`{text}`"

    name = setting["name"]
    facts = [f"type: {setting['type']}", f"allowed: {marked(setting['allowed'])}", f"default: {value(setting['default'])}"]
    if setting["built_in"] not in (None, setting["default"]):
        facts.append(f"built-in scene: {value(setting['built_in'])}")
    if setting["built_in"] is None and setting["example"] != setting["default"]:
        facts.append(f"example: `{setting['example']}`")
    return [f"### `{name}` {{#{anchor(name)}}}", "", marked(setting["meaning"]), "", *[f"- {fact}" for fact in facts], ""]


def anchor(name):
    return name.replace(".", "-")


def way_words(way):
    def link(name):
        return f"all of `[{name[:-1]}]`" if name.endswith(".") else f"[`{name}`](#{anchor(name)})"

    words = ", ".join(map(link, way["by"]))
    return words + (f" (with it {', '.join(map(link, way['with']))})" if way["with"] else "")
