#!/usr/bin/env python3
"""How much code words and shows the answer, before and after: lines by room, functions that return text, words in string literals, notes.

    scripts/checks/count.py [COMMIT ...]

A commit is counted as git has it, HEAD without any. Lines are those of .rs files with their tests. A function returns text where its
type names String, str or Cow; those of the rooms below the faces are counted, without tests, and of the file of numbers as its own row.
A word of a literal is a run of two letters or more in a string of code that has a space; comments and tests are not counted.
Notes are rows of the tables in outcome/note.rs and outcome/rule_note.rs.
"""

import re
import subprocess
import sys

BELOW = ("outcome", "verdict", "case", "run", "campaign", "study")
NUMBERS = ("outcome/quantity.rs", "outcome/numbers.rs", "outcome/digits.rs", "outcome/apart.rs", "outcome/digits/", "outcome/numbers/")
RETURNS = re.compile(r"\bfn\s+\w+[^;{]*?->\s*([^{;]*?)\s*(?:where\b[^{]*)?\{", re.S)
TEXT = re.compile(r"\b(?:String|str|Cow)\b")
LITERAL = re.compile(r'"(?:[^"\\]|\\.)*"', re.S)


def git(*args):
    return subprocess.run(["git", *args], check=True, capture_output=True, text=True).stdout


def files(commit):
    names = git("ls-tree", "-r", "--name-only", commit, "src").split()
    return {name[4:]: git("show", f"{commit}:{name}") for name in names if name.endswith(".rs")}


def code(text):
    """Without comments and without the tests at its end."""
    text = text.split("#[cfg(test)]\nmod tests {")[0]
    return re.sub(r"(?m)^\s*//.*$", "", text)


def is_test(name):
    return name.endswith(("tests.rs", "_test.rs")) or "/tests/" in name


def rows(table):
    return len(re.findall(r"(?m)^    [A-Z]\w*(?: \{|[(,])", table.split("\nnotes! {")[1].split("\n}\n")[0]))


def count(commit):
    all_files = files(commit)
    room = lambda name: name.split("/")[0].removesuffix(".rs")
    lines = lambda *rooms: sum(text.count("\n") for name, text in all_files.items() if not rooms or room(name) in rooms)
    texts = {name: code(text) for name, text in all_files.items() if not is_test(name)}
    returned = lambda text: sum(bool(TEXT.search(kind)) for kind in RETURNS.findall(text))
    below = {name: text for name, text in texts.items() if room(name) in BELOW}
    numbers = sum(returned(text) for name, text in below.items() if name.startswith(NUMBERS))
    literals = [word for text in texts.values() for said in LITERAL.findall(text) if " " in said
                for word in re.findall(r"[A-Za-z]{2,}", said)]
    notes = {name: rows(all_files[name]) if name in all_files else "-" for name in ("outcome/note.rs", "outcome/rule_note.rs")}
    return {
        "lines of src": lines(),
        "of outcome and verdict": lines("outcome", "verdict"),
        "of words": lines("words"),
        "of report": lines("report"),
        "of run": lines("run"),
        "functions below the faces that return text": sum(map(returned, below.values())) - numbers,
        "of them in the files of numbers": numbers,
        "words in literals": len(literals),
        "notes": notes["outcome/note.rs"],
        "notes of rules": notes["outcome/rule_note.rs"],
    }


commits = sys.argv[1:] or ["HEAD"]
counted = [count(commit) for commit in commits]
print("| | " + " | ".join(commits) + " |\n|" + "---|" * (len(commits) + 1))
for name in counted[0]:
    print(f"| {name} | " + " | ".join(str(of[name]) for of in counted) + " |")
