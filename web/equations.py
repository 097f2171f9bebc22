"""Equations of plain text, as docs/theory.md writes them, in MathML.

>>> print(to_mathml("a = b_0/h"))
<math displaystyle="true"><mi>a</mi><mo>=</mo><mfrac><msub><mi>b</mi><mn>0</mn></msub><mi>h</mi></mfrac></math>
>>> print(to_mathml("V* = M(q) q'²"))
<math displaystyle="true"><msup><mi>V</mi><mo>*</mo></msup><mo>=</mo><mrow><mi>M</mi><mrow><mo>(</mo><mi>q</mi><mo>)</mo></mrow></mrow>\
<msup><mi>q</mi><mrow><mo>′</mo><mn>2</mn></mrow></msup></math>
>>> print(to_mathml("(<u, w> - 1)/2 >= 0"))
<math displaystyle="true"><mfrac><mrow><mrow><mo>⟨</mo><mi>u</mi><mo>,</mo><mi>w</mi><mo>⟩</mo></mrow><mo>−</mo><mn>1</mn></mrow>\
<mn>2</mn></mfrac><mo>≥</mo><mn>0</mn></math>
>>> to_mathml("N > 0,   |e| < t").count("<math")  # A line may break at a wide space.
2
"""
import html
import re

CLOSING = {"(": ")", "[": "]", "{": "}", "⟨": "⟩", "|": "|"}
SIGNS = {"<=": "≤", ">=": "≥", "-": "−", "Σ": "∑", "'": "′", "⁻": "−", "⁺": "+", "ᵀ": "T", "¦": "|"}
SQUARES = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
FUNCTIONS = {"sin", "cos", "tan", "atan", "min", "max", "sign", "ln", "clamp", "Var"}
SPACE = '<mspace width="0.17em"/>'
TOKEN = re.compile(
    # A wide space that is not before a relation; words, but no differentials, also with the number of an equation; others.
    r" {2,}(?![<>]?=)"
    r"|(?:\b(?:a(?! sin| cos)|(?!d[a-z]\b)[a-z]{2,}) )*(?!d[a-z]\b)[a-z]{2,}(?: \(\d+\))?"
    r"|Var|_[A-Za-z0-9α-ω]+|\d+(?:\.\d+)?|<=|>=|\S"
)


def with_indices(text):
    """Returns prose whose symbols with an index, such as q_c, are set as in equations; code and links stay."""
    return re.sub(r"(`[^`]*`|\]\([^)]*\))|(?<!\w)[Δd]?[A-Za-zα-ωΑ-Ω]_[A-Za-z0-9]+\b'*", lambda match: match[1] or to_mathml(match[0]), text)


def of_block(block):
    """Returns a block of code as equations if its last line has a number, such as (26a)."""
    if not re.search(r" {2,}\(\d+[a-z]?\)\n*$", block):
        return block
    rows = []
    for line in block.strip("\n").splitlines():
        text, number = re.fullmatch(r"(.*?)(?: {2,}(\(\d+[a-z]?\)))?", line).groups()
        rows.append(f'<div class="equation"><div>{to_mathml(text)}</div><div>{number or ""}</div></div>\n')
    return "".join(rows)


def to_mathml(text):
    """Returns the elements of a line. Brackets touch their content; relations, and the bar of a condition, have spaces on both sides."""
    text = re.sub(r"(?<=\S)>(?!=)", "⟩", re.sub(r"<(?=[^\s=])", "⟨", text.strip().replace(" | ", " ¦ ")))
    # Each token, with whether it touches the one before.
    reader = Reader([(match[0], match.start() > 0 and text[match.start() - 1] != " ") for match in TOKEN.finditer(text)])
    pieces = [[]]
    while reader.tokens:
        if reader.tokens[-1][0].isspace():
            reader.tokens.pop()
            pieces.append([])
        else:
            pieces[-1].append(reader.term())
    return " ".join(f'<math displaystyle="true">{"".join(piece)}</math>' for piece in pieces)


def leaf(token):
    """Returns the element of a token."""
    if token.isspace():
        return '<mspace width="1em"/>'
    if token.isascii() and token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token in "⁰¹²³⁴⁵⁶⁷⁸⁹":
        return f"<mn>{token.translate(SQUARES)}</mn>"
    if token in "Σᵀ" or not token[0].isalpha():
        return f"<mo>{html.escape(SIGNS.get(token, token), quote=False)}</mo>"
    return f"<mi>{token}</mi>" if len(token) == 1 or token in FUNCTIONS else f"<mtext>&nbsp;{token}&nbsp;</mtext>"


def row(parts):
    """Returns one element of several."""
    return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"


class Reader:
    """Reads tokens, of which the last is the first of the line."""

    def __init__(self, tokens):
        self.tokens = tokens[::-1]

    def touches(self, pattern):
        """Returns true if the next token matches and touches the one before."""
        return bool(self.tokens) and self.tokens[-1][1] and bool(re.match(pattern, self.tokens[-1][0]))

    def term(self):
        """Reads an element, or a fraction if a slash touches it. The slash remains beside another fraction, which would be too small."""
        whole, bare = self.factor()
        if not self.touches("/"):
            return whole
        self.tokens.pop()
        whole_below, bare_below = self.factor()
        if "<mfrac>" in bare + bare_below:
            return row([whole, "<mo>/</mo>", whole_below])
        return f"<mfrac>{bare}{bare_below}</mfrac>"

    def factor(self):
        """Reads an element with its indices and arguments; returns it also without parentheses around all of it."""
        token = self.tokens.pop()[0]
        whole = bare = leaf(token)
        if token in CLOSING:
            inside = []
            while self.tokens[-1][0] != CLOSING[token]:
                inside.append(self.term())
            self.tokens.pop()
            whole = bare = row([leaf(token), *inside, leaf(CLOSING[token])])
            if token == "(":
                bare = row(inside)
        elif token == "√":
            whole = bare = f"<msqrt>{self.factor()[1]}</msqrt>"
        below, above = "", []
        while self.touches(r"[_'*⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻ᵀ]"):
            index = self.tokens.pop()[0]
            if index == "_":
                below = re.sub("<mfrac>(.*?</m.>)(.*?)</mfrac>", r"\1<mo>/</mo>\2", self.factor()[1])
            elif index[0] == "_":
                below = f"<mn>{index[1:]}</mn>" if index[1:].isdigit() else f"<mi>{index[1:]}</mi>"
            else:
                above.append(leaf(index))
        if below or above:
            tag = "munder" if token == "Σ" else "m" + "sub" * bool(below) + "sup" * bool(above)
            whole = bare = f"<{tag}>{whole}{below}{row(above) if above else ''}</{tag}>"
        if token in FUNCTIONS:
            whole = bare = row([SPACE, whole, SPACE])
        if token[0].isalpha() and (self.touches(r"[(\[]") or token in "dΔ" and self.touches(r"[^\W\d_]")):
            whole = bare = row([whole, self.factor()[0]])
        return whole, bare
