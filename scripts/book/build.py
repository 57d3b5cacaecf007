"""Builds the book: build.py VOIDWALK FOLDER [--update]

    src, tutorials, src/docs, results, the program's own help and schema -> one folder of Markdown -> mdBook -> links and names are checked

FOLDER/html is the book. The commands of the tutorials run in FOLDER/work. With --update what they print is written into the tutorials where
it differs; read the text around it again. Exit codes: 0 done, 1 where a page says what is not so or a link is dead.
"""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import console
import gallery
import links
import mentions
import pages
import reference

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent

# Pages of tutorials/, in the order of the book; their commands are run, side by side.
TUTORIALS = ["engineer", "researcher", "granular", "cluster", "developer", "gallery"]

# In the order of the book; a page of src/docs that is missing here is an error.
DOCS = ["soils", "rules", "design", "boundary", "uncertainty", "graph", "arches", "campaigns", "long_runs", "files", "stability", "serve", "python"]

# What the results are too large for, or no reader's.
NOT_SHOWN = shutil.ignore_patterns("same-bits.json")


def main():
    binary, out, update = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), "--update" in sys.argv
    begun = time.monotonic()
    source, work = out / "markdown", out / "work"
    for folder in (source, work, out / "html"):
        shutil.rmtree(folder, ignore_errors=True)
    source.mkdir(parents=True)
    results = copy_results(source)
    tutorials = run_tutorials(source, work, binary, update)
    commands = write_commands(source, binary)
    docs = write_docs(source)
    (source / "scene.md").write_text(reference.scene_page(binary))
    write_front(source, results, commands)
    write_summary(source, tutorials, write_gallery(source), docs, commands, results)
    subprocess.run([os.environ.get("MDBOOK", "mdbook"), "build", HERE, "--dest-dir", out / "html"],
                   check=True, env={**os.environ, "MDBOOK_BOOK__SRC": str(source), "MDBOOK_LOG": "warn"})
    dead, outside = links.dead(out / "html")
    wrong = wrong_names(source, binary, commands)
    for fault in dead + wrong:
        print(fault, file=sys.stderr)
    if dead or wrong:
        raise SystemExit(f"{len(dead)} dead links, {len(wrong)} names that the program does not know")
    print(f"{out / 'html' / 'index.html'}: {len(list(source.rglob('*.md'))) - 1} pages, no dead link, {outside} links to the web not "
          f"followed, {time.monotonic() - begun:.0f} s")


def run_tutorials(source, work, binary, update):
    """The tutorials with what their commands print, each in a folder of its own; their titles."""
    held_to("tutorials", HERE / "tutorials", TUTORIALS)

    def one(name):
        folder = work / name
        folder.mkdir(parents=True)
        path = HERE / "tutorials" / f"{name}.md"
        shown, written = console.page(path.read_text(), path.name, folder, binary, source / "runs", update)
        (source / path.name).write_text(shown)
        if written != path.read_text():
            path.write_text(written)
            print(f"{path}: written again; read the text around it")
        return pages.title_of(shown)

    # No more at a time than there are processors, mostly: some wait for moments of their own walks.
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        return dict(zip(TUTORIALS, pool.map(one, TUTORIALS)))


def write_gallery(source):
    """The gallery as one page a picture; their titles."""
    shown, pictures, titles = gallery.split((source / "gallery.md").read_text(), "gallery")
    (source / "gallery.md").write_text(shown)
    (source / "gallery").mkdir()
    for name, text in pictures.items():
        (source / "gallery" / f"{name}.md").write_text(text)
    return titles


def held_to(what, folder, listed):
    """A page that is there and not listed, or the other way round, is an error."""
    there = {path.stem for path in folder.glob("*.md")}
    if there != set(listed):
        raise SystemExit(f"{what}: {folder} and the list in {pathlib.Path(__file__).name} differ: {', '.join(sorted(there ^ set(listed)))}")


def wrong_names(source, binary, commands):
    """Commands, options and settings that the pages name and the program does not know; results are of their date."""
    texts = {path.name: path.read_text() for path in [*source.glob("*.md"), *source.glob("gallery/*.md"), ROOT / "README.md"]}
    return mentions.faults(texts, {name: reference.options(binary, name) for name in commands}, reference.settings(binary))


def write_commands(source, binary):
    """One page a command, and what each does."""
    (source / "commands").mkdir()
    abouts = {}
    for name in reference.commands(binary):
        abouts[name], page = reference.command_page(binary, name)
        (source / "commands" / f"{name}.md").write_text(page)
    return abouts


def write_docs(source):
    """The pages of src/docs, with their titles."""
    held_to("guide", ROOT / "src" / "docs", DOCS)
    titles = {}
    for name in DOCS:
        text = pages.docs_page((ROOT / "src" / "docs" / f"{name}.md").read_text(), set(DOCS))
        (source / f"{name}.md").write_text(text)
        titles[name] = pages.title_of(text)
    return titles


def copy_results(source):
    """The results as they are, and the titles of their pages."""
    shutil.copytree(ROOT / "results", source / "results", ignore=NOT_SHOWN)
    for path in (source / "results").rglob("README.md"):
        path.rename(path.with_name("index.md"))
    found = sorted((source / "results").rglob("*.md"), key=lambda path: (path != source / "results" / "index.md", path))
    return {path.relative_to(source): pages.title_of(path.read_text()) for path in found}


def write_front(source, results, commands):
    """Pages of the book's own: with equations, and with what is made from other files where `{{name}}` stands."""
    figures = (source / "results" / "paper" / "figures").glob("*.svg")
    made = {
        "commands": "\n".join(f"| [`voidwalk {name}`](commands/{name}.md) | {about} |" for name, about in commands.items()),
        "results": "\n".join(f"- [{title}]({path})" for path, title in results.items()),
        "paper_figures": pages.paper_figures(figures, source / "results"),
    }
    for path in (HERE / "src").glob("*.md"):
        if path.name == "SUMMARY.md":
            continue
        text = pages.with_equations(path.read_text())
        (source / path.name).write_text(re.sub(r"\{\{(\w+)\}\}", lambda match: made[match[1]], text))


def write_summary(source, tutorials, pictures, docs, commands, results):
    """The table of contents, with the pages that were made."""
    made = {
        "tutorials": [f"- [{title}]({name}.md)" for name, title in tutorials.items()],
        "pictures": [f"  - [{title}]({path})" for path, title in pictures.items()],
        "docs": [f"- [{title}]({name}.md)" for name, title in docs.items()],
        "commands": [f"  - [voidwalk {name}](commands/{name}.md)" for name in commands],
        "results": [f"  - [{title}]({path})" for path, title in results.items()],
    }
    text = (HERE / "src" / "SUMMARY.md").read_text()
    (source / "SUMMARY.md").write_text(re.sub(r"^ *\{\{(\w+)\}\}$", lambda match: "\n".join(made[match[1]]), text, flags=re.M))


if __name__ == "__main__":
    try:
        main()
    except (console.Stale, subprocess.CalledProcessError) as error:
        raise SystemExit(str(error))
