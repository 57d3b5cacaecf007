"""One page a picture, from the page on which the gallery stands as a whole.

The page begins with words and files for all pictures. Each of its sections is one picture with the command that makes it; a section without a
command shows another picture of the command before it.
"""

import re

IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)]+)\)")
FENCES = re.compile(r"(?:^`[^`\n]+`:\n\n)?^```.*?^```$", re.M | re.S)


def split(shown, folder):
    """The page that leads to the pictures; the page of each, by its name in `folder`; and their titles."""
    intro, *sections = re.split(r"^## ", shown, flags=re.M)
    words, pages, titles, entries, made = FENCES.sub("", intro), {}, {}, [], []
    for section in sections:
        title, body = section.split("\n", 1)
        images = IMAGE.findall(body)
        if len(images) != 1:
            raise SystemExit(f"gallery: `{title}` has {len(images)} pictures; each has a section of its own")
        if "```console" in body:
            made = FENCES.findall(body)
        else:
            body = "\n\n".join(["Made by the same command as the picture before it:", *made, body.strip()])
        # Soils that stand above all sections, on the pages of those that read them.
        soils = [fence for fence in FENCES.findall(intro) if fence.split("`")[1] in "".join(made)]
        name = re.sub(r"\W+", "-", title.lower())
        titles[f"{folder}/{name}.md"] = title
        pages[name] = re.sub(r"\]\((?!https?:|#)", "](../", "\n\n".join([f"# {title}", *soils, body.strip()])) + "\n"
        entries.append(f"## [{title}]({folder}/{name}.md)\n\n[![{images[0][0]}]({images[0][1]})]({folder}/{name}.md)")
    words = re.sub(r"\n{3,}", "\n\n", words).strip()
    return "\n\n".join([words, *entries]) + "\n", pages, titles
