"""Pages that exist elsewhere in the repository, made ready for the book; and equations."""

import html
import re

import latex2mathml.converter


def docs_page(text, known):
    """A page of src/docs: its first paragraph, to the first colon or end of a sentence, is the title unless it has one, and links to
    Rust items become names.

    `known` are the pages of src/docs that a link can lead to.
    """
    if not text.startswith("# "):
        first, rest = text.split("\n\n", 1)
        title, end, more = re.match(r"(.*?)([:.?])(?:\s(.*))?$", " ".join(first.split())).groups()
        text = f"# {title}{'?' if end == '?' else ''}\n\n" + (first + "\n\n" if more else "") + demoted(rest)

    def link(match):
        words, item = match[1], match[2]
        page = item.removeprefix("crate::docs::")
        return f"[{words.strip('`')}]({page}.md)" if page in known else words

    return re.sub(r"\[([^\]]+)\]\((crate::[\w:]+)\)", link, text)


def title_of(text):
    """The first heading."""
    return re.search(r"^# (.+)$", text, re.M)[1].strip()


def demoted(text):
    """Every heading one step lower; not the comments in code."""
    lines, in_code = [], False
    for line in text.split("\n"):
        in_code ^= line.startswith("```")
        lines.append("#" + line if re.match(r"#+ ", line) and not in_code else line)
    return "\n".join(lines)


def with_equations(text):
    """`$$...$$` and `$...$` as MathML, which browsers draw by themselves."""
    def drawn(match):
        is_block = match[1] is not None
        tex = match[1] or match[2]
        math = latex2mathml.converter.convert(tex.strip(), display="block" if is_block else "inline")
        # Markdown must take nothing of it for its own.
        return math.replace("\n", "").replace("*", "&#42;").replace("_", "&#95;").replace("\\", "&#92;")

    return re.sub(r"\$\$(.+?)\$\$|\$([^$\n]+)\$", drawn, text, flags=re.S)


def paper_figures(figures, results):
    """Every figure with its own title and description."""
    page = []
    for path in sorted(figures, key=lambda path: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path.stem)]):
        svg = path.read_text()
        title, about = (html.unescape(re.search(rf"<{tag} [^>]*>(.*?)</{tag}>", svg, re.S)[1]) for tag in ("title", "desc"))
        number = re.sub(r"fig(\d+)", r"Fig. \1", path.stem)
        heading = title if title.startswith("Fig. ") else f"{number}: {title}"
        page += [f"### {heading}", "", f"![{title}]({path.relative_to(results.parent)})", ""]
        page += [about.rstrip(".") + ".", ""] if about not in ("", title) else []
    return "\n".join(page)
