"""Rust source as .ci/lines and .ci/circles read it: without comments, texts and unit tests, every character at its place.

Its examples are its tests: `python3 -m doctest .ci/rust_source.py`.
"""
import re

_TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<text>\b(?:br|r|cr)(?P<hashes>\#*)".*?"(?P=hashes) | \b[bc]?"(?:\\.|[^"\\])*" | "(?:\\.|[^"\\])*"
        | b?'(?:\\(?:u\{[^}]*\}|x..|.)|[^\\'\n])')""",
    re.DOTALL | re.VERBOSE,
)
_CLOSING = {"(": ")", "[": "]", "{": "}"}


def masked(text: str) -> str:
    """Comments become blanks, and texts a row of quotation marks; lines stay lines.

    >>> masked('let a = "fn{"; // b').replace('"', "-").rstrip()
    'let a = -----;'
    >>> masked("fn a<'b>(c: &'b str) { '{' }").replace('"', "-")
    "fn a<'b>(c: &'b str) { --- }"
    """

    def mask(token: re.Match[str]) -> str:
        return re.sub(r"\S", " " if token["comment"] else '"', token[0])

    return _TOKEN.sub(mask, text)


def tokens(text: str) -> int:
    """The number of tokens of masked source: a measure of size that does not depend on the formatter.

    >>> tokens(masked('a::b(c, "d e") // f'))
    8
    """
    return len(re.findall(r'"["\s]*"|\w+|::|->|=>|\S', text))


def end_of_group(text: str, start: int) -> int:
    """The position after the bracket that closes the one at `start`.

    >>> end_of_group("a(b[c])d", 1)
    7
    """
    depth = 0
    for place in range(start, len(text)):
        if text[place] in "([{":
            depth += 1
        elif text[place] in ")]}":
            depth -= 1
            if depth == 0:
                return place + 1
    return len(text)


def end_of_item(text: str, start: int) -> int:
    """The position after an item: after its `;` or its block.

    >>> source = "fn a(b: [f64; 2]) { c; } d"
    >>> source[end_of_item(source, 0):]
    ' d'
    """
    place = start
    is_import = re.match(r"\s*(pub(\([^)]*\))?\s+)?use\b", text[start:])
    while place < len(text):
        if text[place] == ";":
            return place + 1
        if text[place] in "([{":
            end = end_of_group(text, place)
            if text[place] == "{" and not is_import:
                return end
            place = end
        else:
            place += 1
    return len(text)


_TEST = re.compile(r"#\[cfg\(test\)\]\s*(#\[[^\]]*\]\s*)*")


def without_tests(text: str) -> str:
    """Masked source without the items of `#[cfg(test)]`.

    >>> without_tests("a;\\n#[cfg(test)]\\nmod tests {\\n    b;\\n}\\nc;\\n").split()
    ['a;', 'c;']
    """
    while found := _TEST.search(text):
        end = end_of_item(text, found.end())
        text = text[: found.start()] + re.sub(r"\S", " ", text[found.start() : end]) + text[end:]
    return text


def test_modules(text: str) -> set[str]:
    """Names of the modules that are files of unit tests.

    >>> test_modules("#[cfg(test)]\\nmod tests;\\nmod a;")
    {'tests'}
    """
    return set(re.findall(r"#\[cfg\(test\)\]\s*mod\s+(\w+)\s*;", text))


def code_lines(text: str) -> int:
    """Lines that are not blank once comments are gone."""
    return sum(1 for line in text.splitlines() if line.strip())


def functions(text: str) -> list[tuple[str, int]]:
    """Name and lines of code of every function with a body, in masked source.

    >>> functions("fn a(\\n    b: C,\\n) {\\n    d\\n}\\ntrait E {\\n    fn f();\\n}\\n")
    [('a', 5)]
    """
    found = []
    for function in re.finditer(r"\bfn\s+(\w+)", text):
        end = end_of_item(text, function.end())
        if text[end - 1] == "}":
            found.append((function[1], code_lines(text[function.start() : end])))
    return found
