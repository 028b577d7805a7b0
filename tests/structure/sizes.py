#!/usr/bin/env python3
"""Fails if a file or a function is too long, or if prose breaks a rule that can be counted.

    tests/structure/sizes.py

- No file of Rust has more than 900 lines, and no function more than 80, but those that exceptions.toml lists with a reason.
- At most 40 comments begin with What, Who, Whose, Which, Where or Whether.
- No doc comment has fewer than three words.
- Spelling is American: in code, documents and scenes.
"""

import re
import sys
import tomllib

import rust

FILE_LINES = 900
FUNCTION_LINES = 80
QUESTIONS = 40
DOC_WORDS = 3

QUESTION = re.compile(r"^\s*//[/!]? *(What|Who|Whose|Which|Where|Whether)\b", re.MULTILINE)
DOC = re.compile(r"(?:^[ \t]*///[^\n]*\n)+|(?:^[ \t]*//![^\n]*\n)+", re.MULTILINE)
FUNCTION = re.compile(r"\bfn\s+([A-Za-z_][A-Za-z0-9_]*)")

# British spellings, each with the end of its word left open unless `$` closes it.
BRITISH = """
    favour honour humour harbour labour vapour rumour armour flavour endeavour
    litre fibre theatre calibre sombre
    grey defence offence licence$ pretence artefact aluminium sulphur mould plough programme$ programmes$
    analys(e|es|ed|ing)$ catalyse paralyse
    modell(ed|ing) labell(ed|ing) travell(ed|ing|er) cancell(ed|ing)$ levell(ed|ing) signall(ed|ing) tunnell
    channell(ed|ing) fuell(ed|ing) dialled totall(ed|ing) initiall(ed|ing) marshall(ed|ing)
    whilst amongst learnt spelt$ judgement ageing$ acknowledgement fulfil$ fulfilment enrol$ skilful
""".split()

# Stems whose verbs end in -ise and -isation in Britain.
STEMS = """
    normal optim initial minim maxim regular organ recogn summar serial general discret linear stabil
    visual quant real vector parallel symmetr equal character categor emphas penal polar random special
    synchron util raster token final factor diagonal material neutral digit local global rational memor
    priorit custom author apolog critic standard computer model capital central familiar crystal
    orthogonal homogen ideal individual mobil modern monopol orthonormal parameter pulver sanit scrutin
    sensit steril subsid symbol terror trivial vapor vandal fossil fertil hypothes idol immun item legal
    liberal mechan moral national nasal oxid plural popular pressur public reorgan republic
""".split()

SPELLING = re.compile(
    r"(?<![A-Za-z])("
    + "|".join(word.replace("$", r"(?![a-z])") for word in BRITISH)
    + r"|[a-z]*(?:colour|centre|metre|neighbour|behaviour)"
    + r"|(?:re|de|un|over|under)?-?(?:"
    + "|".join(STEMS)
    + r")is(?:e|es|ed|ing|er|ers|ation|ations|able)(?![a-z]))",
    re.IGNORECASE,
)
PROSE = [".rs", ".md", ".toml", ".py", ".sh", ".txt", ".wgsl", ".snap", ".yml", ".json"]


def functions(code):
    """Each function with a body: name, first and last line."""
    for found in FUNCTION.finditer(code):
        end = rust.block_end(code, found.end())
        if code[end - 1] == "}":
            first = code.count("\n", 0, found.start()) + 1
            yield found.group(1), first, code.count("\n", 0, end) + 1


def words(comment):
    """Words of a doc comment, without its signs; a formula or a unit is a word as well."""
    text = re.sub(r"^[ \t]*//[/!]", "", comment, flags=re.MULTILINE)
    return [word for word in text.split() if re.search(r"\w", word)]


def main():
    exceptions = tomllib.loads((rust.ROOT / "tests/structure/exceptions.toml").read_text())
    faults, questions, needed = [], [], set()
    for path in sorted(rust.ROOT.glob("crates/**/*.rs")):
        name, text = str(path.relative_to(rust.ROOT)), path.read_text()
        code = rust.code(text)
        lines = text.count("\n")
        if lines > FILE_LINES:
            needed.add(name)
            if name not in exceptions["files"]:
                faults.append(f"{name}: {lines} lines; at most {FILE_LINES}, or a reason in exceptions.toml")
        for function, first, last in functions(code):
            if last - first + 1 > FUNCTION_LINES:
                key = f"{name} {function}"
                needed.add(key)
                if key not in exceptions["functions"]:
                    faults.append(f"{name}:{first}: {function} has {last - first + 1} lines; at most {FUNCTION_LINES}")
        for found in QUESTION.finditer(text):
            questions.append(f"{name}:{text.count(chr(10), 0, found.end()) + 1}: begins with {found.group(1)}")
        for found in DOC.finditer(text):
            if len(words(found.group())) < DOC_WORDS:
                line = text.count("\n", 0, found.start()) + 1
                faults.append(f"{name}:{line}: fewer than {DOC_WORDS} words: {found.group().strip()}")
    for key in [*exceptions["files"], *exceptions["functions"]]:
        if key not in needed:
            faults.append(f"tests/structure/exceptions.toml: {key} needs no exception")
    faults += spelling(exceptions["spelling"])
    if len(questions) > QUESTIONS:
        faults += questions
        faults.append(f"{len(questions)} comments begin with a question word; at most {QUESTIONS}")
    print("\n".join(faults) if faults else "sizes and prose keep to the rules")
    return bool(faults)


def spelling(exceptions):
    """British words in files that Git tracks."""
    faults = []
    for name in rust.tracked():
        path = rust.ROOT / name
        # The corpus holds inputs, and this folder the words to look for.
        if path.suffix not in PROSE or name.startswith(("fuzz/corpus/", "tests/structure/")):
            continue
        allowed = exceptions.get(name, [])
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for found in SPELLING.finditer(line):
                if found.group() not in allowed:
                    faults.append(f"{name}:{number}: {found.group()}: British")
    return faults


if __name__ == "__main__":
    sys.exit(main())
