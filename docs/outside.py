"""A preprocessor of mdBook: pages that are files of the repository, and links that lead out of docs/.

A page that is nothing but `{{#include ../../FILE.md}}` gets that file. A link out of docs/ leads to the page of its file if there is one; the others, to scenes, schemas and code, name
the path, since the book does not hold them.
"""

import json
import os
import pathlib
import re
import sys

INCLUDE = re.compile(r"\{\{#include (\S+\.md)\}\}\s*\Z")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")


def chapters(items):
    for item in items:
        chapter = item.get("Chapter") if isinstance(item, dict) else None
        if chapter:
            yield chapter
            yield from chapters(chapter["sub_items"])


def redirect(text, folder, here, docs, pages):
    """The text of a page at `here`, whose links are relative to `folder`, with links that work in the book."""

    def link(match):
        picture, name, target = match.groups()
        path, _, anchor = target.partition("#")
        if "://" in target or not path:
            return match.group(0)
        file = (folder / path).resolve()
        if file in pages:
            place = os.path.relpath(pages[file], here.parent)
        elif file.is_relative_to(docs):
            place = os.path.relpath(file, here.parent)
        elif picture:
            return f"*({name})*"
        else:
            inside = file.relative_to(docs.parent)
            return f"`{inside}`" if name.strip("`") in (str(inside), file.name, path) else f"{name} (`{inside}`)"
        return f"{picture}[{name}]({place}{'#' + anchor if anchor else ''})"

    # Code stays as it is: blocks, and what stands between backticks, unless it is the name of a link.
    parts = re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)
    return "".join(part if i % 2 else LINK.sub(link, part) for i, part in enumerate(parts))


def main():
    if len(sys.argv) > 1:
        # `supports RENDERER`: all of them.
        return
    context, book = json.load(sys.stdin)
    docs = pathlib.Path(context["root"]).resolve()
    if not docs.joinpath("SUMMARY.md").exists():
        docs /= "docs"
    found = list(chapters(book["items"]))
    pages = {}
    for chapter in found:
        include = INCLUDE.match(chapter["content"])
        if include:
            pages[(docs / chapter["path"]).parent.joinpath(include[1]).resolve()] = docs / chapter["path"]
    for chapter in found:
        here = docs / chapter["path"]
        include = INCLUDE.match(chapter["content"])
        file = here.parent.joinpath(include[1]).resolve() if include else here
        text = file.read_text(encoding="utf-8") if include else chapter["content"]
        chapter["content"] = redirect(text, file.parent, here, docs, pages)
    json.dump(book, sys.stdout)


main()
