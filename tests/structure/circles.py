#!/usr/bin/env python3
"""Fails if files of different folders import each other in a circle.

    tests/structure/circles.py [--arrows]

In each crate, file A imports file B if code of A names an item that B defines. A name that is handed on by a `use` of
another module counts for the file that defines it. A `mod` line is no import, nor is a `pub use` whose name the file
itself does not use. Tests do not count. A circle is a strongly connected component of files in two or more folders;
`x.rs` beside a folder `x` belongs to that folder, as `x/mod.rs` does. With --arrows every import is listed.
"""

import re
import sys
from dataclasses import dataclass, field

import rust

IDENT = r"(?:r#)?[A-Za-z_][A-Za-z0-9_]*"
DEFINITION = re.compile(
    rf"\b(?:fn|struct|enum|trait|type|const|static|union|macro_rules!)\s+(?:mut\s+)?({IDENT})"
)
MODULE = re.compile(rf"\bmod\s+({IDENT})\s*([;{{])")
USE = re.compile(r"(\bpub\s*(?:\([^)]*\)\s*)?)?\buse\s+([^;]*);")
PATH = re.compile(rf"(?<![A-Za-z0-9_:.])\$?({IDENT}(?:\s*::\s*{IDENT})+)")


@dataclass
class Module:
    """A module: its file, the modules in it and the names it knows."""

    file: object
    path: tuple
    children: dict = field(default_factory=dict)
    # Name → path as written, for names brought in by `use`; those of `pub use` are handed on.
    uses: dict = field(default_factory=dict)
    public: set = field(default_factory=set)
    globs: list = field(default_factory=list)
    defined: set = field(default_factory=set)
    # Its code without `use` and `mod` lines.
    used: str = ""


def use_leaves(tree, prefix=()):
    """Each (path, name) that a use tree brings in; the name of a glob is `*`."""
    tree = tree.strip()
    depth, parts, last = 0, [], 0
    for i, c in enumerate(tree):
        depth += (c == "{") - (c == "}")
        if c == "," and depth == 0:
            parts.append(tree[last:i])
            last = i + 1
    parts.append(tree[last:])
    for part in filter(None, (part.strip() for part in parts)):
        if (brace := part.find("{")) >= 0:
            inner = tuple(part[:brace].replace(" ", "").split("::")[:-1])
            yield from use_leaves(part[brace + 1 : part.rindex("}")], prefix + inner)
            continue
        part, _, alias = part.partition(" as ")
        path = prefix + tuple(part.replace("\n", " ").replace(" ", "").split("::"))
        path = tuple(segment.removeprefix("$") for segment in path)
        if path[-1] == "self":
            path = path[:-1]
        yield path, alias.strip() or path[-1]


def read(file, path, text, modules):
    """Adds the module with this code, and those within it, to `modules`."""
    module = Module(file, path)
    modules[path] = module
    # Modules written in place are modules of their own.
    at = 0
    while found := MODULE.search(text, at):
        name, at = found.group(1), found.end()
        if found.group(2) == "{":
            at = rust.block_end(text, found.end() - 1)
            module.children[name] = read(file, path + (name,), text[found.end() : at - 1], modules)
            text = text[: found.start()] + rust.blank(text[found.start() : at]) + text[at:]
        else:
            attributes = text[max(0, found.start() - 200) : found.start()]
            moved = re.search(r'#\[path = "([^"]*)"\]\s*(?:pub[^;{}]*)?$', attributes)
            if moved:
                raise SystemExit(f"{file}: #[path] is not understood here")
            child = child_file(file, path, name)
            if child:
                code = rust.without_tests(rust.code(child.read_text()))
                module.children[name] = read(child, path + (name,), code, modules)
    for found in USE.finditer(text):
        for target, name in use_leaves(found.group(2)):
            if name == "*":
                module.globs.append((target[:-1], bool(found.group(1))))
            else:
                module.uses[name] = target
                if found.group(1):
                    module.public.add(name)
    module.used = re.sub(rf"\bmod\s+{IDENT}\s*;", "", USE.sub("", text))
    module.defined = set(DEFINITION.findall(text))
    return module


def child_file(file, path, name):
    """The file of `mod name;` in a module, if it exists (it does not for tests that were left out)."""
    name = name.removeprefix("r#")
    head = file.name in ("mod.rs", "lib.rs", "main.rs")
    folder = file.parent if head else file.parent / file.stem
    for child in (folder / f"{name}.rs", folder / name / "mod.rs"):
        if child.exists():
            return child
    return None


def resolve(modules, module, path, seen=()):
    """The file that defines the item of a path as seen from a module; nothing for a path out of the crate."""
    if (module.path, path) in seen:
        return None
    seen = seen + ((module.path, path),)
    first, rest = path[0], path[1:]
    if first == "crate":
        return walk(modules, modules[()], rest, seen)
    if first == "self":
        return walk(modules, module, rest, seen)
    if first == "super":
        return walk(modules, modules[module.path[:-1]], rest, seen) if module.path else None
    if first in module.children or first in module.uses or first in module.defined:
        return walk(modules, module, path, seen)
    return walk_globs(modules, module, path, seen)


def walk(modules, module, path, seen):
    """Follows a path that begins in a module."""
    if not path:
        return module
    first, rest = path[0], path[1:]
    if first == "super":
        return walk(modules, modules[module.path[:-1]], rest, seen) if module.path else None
    if first in module.children:
        return walk(modules, module.children[first], rest, seen)
    if first in module.defined:
        return module
    if first in module.uses:
        target = module.uses[first] + rest
        if target[0] == first:  # A crate of the same name as what is brought in.
            return None
        return resolve(modules, module, target, seen)
    return walk_globs(modules, module, path, seen)


def walk_globs(modules, module, path, seen):
    """Follows a path through what `use ..::*` brings into a module."""
    for target, _ in module.globs:
        source = resolve(modules, module, target, seen)
        if source and (found := walk(modules, source, path, seen + ((module.path, path),))):
            return found
    return None


def imports(modules, module):
    """Files that code of a module names items of, each with these names."""
    found = {}

    def add(path):
        target = resolve(modules, module, path)
        if target and target.file != module.file:
            found.setdefault(target.file, set()).add(path[-1])

    for name, path in module.uses.items():
        if name in module.public and not re.search(rf"(?<![$.\w]){re.escape(name)}\b", module.used):
            continue
        target = resolve(modules, module, path)
        # A module that is brought in counts by what is named of it.
        if target and not (path[-1] == (target.path or ("crate",))[-1] and target.children):
            add(path)
    for written in PATH.findall(module.used):
        add(tuple(re.sub(r"\s", "", written).split("::")))
    words = set(re.findall(IDENT, module.used)) if module.globs else ()
    for target, public in module.globs:
        source = resolve(modules, module, target)
        for name in words if source else ():
            if name not in module.defined and name not in module.uses and walk(modules, source, (name,), ()):
                add(target + (name,))
    return found


def graph(crate):
    """The imports of a crate: file → file → names."""
    arrows = {}
    for root in (crate / "src/lib.rs", crate / "src/main.rs"):
        if root.exists():
            modules = {}
            read(root, (), rust.without_tests(rust.code(root.read_text())), modules)
            for module in modules.values():
                targets = arrows.setdefault(module.file, {})
                for file, names in imports(modules, module).items():
                    targets.setdefault(file, set()).update(names)
    return arrows


def components(arrows):
    """Strongly connected components with more than one file (Tarjan's, without recursion)."""
    index, low, stack, on_stack, out = {}, {}, [], set(), []
    for root in arrows:
        if root in index:
            continue
        work = [(root, iter(arrows[root]))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            node, targets = work[-1]
            for target in targets:
                if target not in index:
                    index[target] = low[target] = len(index)
                    stack.append(target)
                    on_stack.add(target)
                    work.append((target, iter(arrows.get(target, {}))))
                    break
                if target in on_stack:
                    low[node] = min(low[node], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    component = set()
                    while node not in component:
                        component.add(stack.pop())
                    on_stack -= component
                    if len(component) > 1:
                        out.append(component)
    return out


def folder(file):
    """The folder a file belongs to."""
    inner = file.parent / file.stem
    return inner if inner.is_dir() else file.parent


def main():
    failed = False
    for crate in rust.crates():
        arrows = graph(crate)
        name = lambda file: str(file.relative_to(crate / "src"))
        if "--arrows" in sys.argv[1:]:
            for file in sorted(arrows):
                for target in sorted(arrows[file]):
                    print(f"{crate.name}: {name(file)} -> {name(target)}: {', '.join(sorted(arrows[file][target]))}")
        for circle in components(arrows):
            folders = {folder(file) for file in circle}
            if len(folders) < 2:
                continue
            failed = True
            print(f"{crate.name}: a circle of {len(circle)} files in {len(folders)} folders")
            for file in sorted(circle):
                for target in sorted(circle & set(arrows[file])):
                    names = ", ".join(sorted(arrows[file][target]))
                    away = "" if folder(file) == folder(target) else "  (another folder)"
                    print(f"    {name(file)} -> {name(target)}: {names}{away}")
    if not failed:
        print("no files of different folders import each other in a circle")
    return failed


if __name__ == "__main__":
    sys.exit(main())
