"""Rust source as the structure checks see it: code without comments, strings and tests."""

import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]

# A comment, a string of either kind, or a character. A lifetime is none of them.
TOKEN = re.compile(
    r"""//[^\n]*
      | /\*
      | (?<![A-Za-z0-9_])(?:br|cr|r)(?P<hashes>\#*)"
      | (?<![A-Za-z0-9_])[bc]?"
      | b?'(?:\\(?:x[0-9a-fA-F]{2}|u\{[^}]*\}|.)|[^\\'\n])'""",
    re.VERBOSE,
)


def crates():
    """The folders of the workspace's crates."""
    return sorted(path.parent for path in ROOT.glob("crates/*/Cargo.toml"))


def blank(text):
    """The same text with spaces for everything but line ends."""
    return re.sub(r"[^\n]", " ", text)


def code(text):
    """The code of a file: comments and the insides of strings are blank, and every line keeps its place."""
    out, at = [], 0
    while found := TOKEN.search(text, at):
        out.append(text[at : found.start()])
        end = found.end()
        token = found.group()
        if token.startswith("/*"):
            depth = 1
            while depth:
                edge = re.compile(r"/\*|\*/").search(text, end)
                if edge is None:
                    end = len(text)
                    break
                depth += 1 if edge.group() == "/*" else -1
                end = edge.end()
        elif found.group("hashes") is not None:
            close = text.find('"' + found.group("hashes"), end)
            end = len(text) if close < 0 else close + 1 + len(found.group("hashes"))
        elif token.endswith('"'):
            string = re.compile(r'(?:[^"\\]|\\.)*"', re.DOTALL).match(text, end)
            end = string.end() if string else len(text)
        out.append(blank(text[found.start() : end]))
        at = end
    out.append(text[at:])
    return "".join(out)


def block_end(text, start):
    """The index after the brace that closes the first one at or after `start`, or after a `;` that comes before it."""
    depth = 0
    for edge in re.compile(r"[{}();\[\]]").finditer(text, start):
        if edge.group() in "{([":
            depth += 1
        elif edge.group() in "})]":
            depth -= 1
            if depth == 0 and edge.group() == "}":
                return edge.end()
        elif depth == 0:
            return edge.end()
    return len(text)


def without_tests(text):
    """Code without the items under `#[cfg(test)]` and `#[test]`."""
    at = 0
    while found := re.compile(r"#\[(?:cfg\(test\)|test)\]").search(text, at):
        end = block_end(text, found.end())
        text = text[: found.start()] + blank(text[found.start() : end]) + text[end:]
        at = end
    return text


def tracked():
    """The files that Git tracks, by their path from the root; links are left out."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True)
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file() and not (ROOT / name).is_symlink()]
