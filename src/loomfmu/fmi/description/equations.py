"""Equations as the READMEs write them, a line of plain text each, typeset as MathML, which browsers draw.

A line has columns, two blanks or more apart: the number, mathematics, remarks, and its place in the source.
"""

import html
import re
import unicodedata

NUMBER = re.compile(r"(?:\((\d+)\)\s+|\s+)?(.*)")
SOURCE = re.compile(r"(own|section|Table|Appendix|from \(|after \(|replaces \(|\(\d)")
RELATION = re.compile(r"[=<>]")
TOKEN = re.compile(r"\s*(\d+\.\d+|\d+|[A-Za-z]\w*|'+|<=|>=|\+-|\.\.|\S)")
OPERATORS = {"<=": "≤", ">=": "≥", "+-": "±", "-": "\N{MINUS SIGN}", "..": "…", "<": "&lt;", ">": "&gt;"}
LETTERS = ("alpha", "chi", "eta", "gamma", "mu", "phi", "pi", "psi", "tau", "theta")
GREEK = {name: unicodedata.lookup(f"GREEK SMALL LETTER {name}") for name in LETTERS}
PRIME = "\N{PRIME}"
FUNCTIONS = {"sin", "cos", "tan", "asin", "acos", "atan2", "exp", "max", "floor", "sqrt", "sum"}
CLOSING = {"(": ")", "[": "]", "|": "|"}
SPACE = '<mspace width="0.2em"/>'


class NotTypeset(ValueError):
    """A text that is not written as mathematics."""


def table(text: str) -> str:
    """A block of equations as an HTML table, or as it stands where it is a table of numbers."""
    lines = [line for line in text.rstrip().split("\n") if line.strip()]
    if any(len(re.findall(r"\s{2,}-?\d+(\.\d+)?(?=\s|$)", line)) > 3 for line in lines):
        return f"<pre><code>{html.escape(text, quote=False)}</code></pre>\n"
    rows = "".join(_row(line) for line in lines)
    return f'<table class="equations">\n{rows}</table>\n'


def _row(line: str) -> str:
    found = NUMBER.fullmatch(line)
    assert found is not None, "every line matches"
    number = f"({found[1]})" if found[1] else ""
    columns = re.split(r"\s{2,}", re.sub(r"\s{2,}=", " =", found[2].strip()))
    source = columns.pop() if len(columns) > 1 and SOURCE.match(columns[-1]) else ""
    shown = "&emsp;".join(_column(column) for column in columns)
    return f"<tr><td>{number}</td><td>{shown}</td><td>{html.escape(source, quote=False)}</td></tr>\n"


def _column(text: str) -> str:
    """A column as mathematics, or as text where it is a remark."""
    words = re.findall(r"[A-Za-z]{2,}", text)
    plain = [word for word in words if word not in FUNCTIONS and word not in GREEK]
    if RELATION.search(text) or (not plain and ":" not in text) or re.search(r"[\])] \(|\^", text):
        try:
            return mathml(text)
        except NotTypeset:
            pass
    return html.escape(text, quote=False)


def mathml(text: str) -> str:
    """A formula in plain text as MathML.

    >>> mathml("F_cr = pi^2 EI / (mu l)^2").count("mfrac")
    2
    >>> mathml("(a")
    Traceback (most recent call last):
    loomfmu.fmi.description.equations.NotTypeset: ')' is missing
    """
    parser = _Parser(text)
    shown = parser.sequence("")
    if parser.token:
        raise NotTypeset(f"{parser.token!r} closes nothing")
    return f'<math displaystyle="true"><mrow>{shown}</mrow></math>'


class _Parser:
    """Sums of products of factors: ` / ` divides the product so far, `/` only the factor before it."""

    def __init__(self, text: str) -> None:
        self.found = [(each[1], each.start() < each.start(1)) for each in TOKEN.finditer(text)]
        self.place = 0

    @property
    def token(self) -> str:
        return self.found[self.place][0] if self.place < len(self.found) else ""

    @property
    def spaced(self) -> bool:
        return self.place < len(self.found) and self.found[self.place][1]

    def take(self) -> str:
        token = self.token
        self.place += 1
        return token

    def sequence(self, closing: str) -> str:
        """Products with signs, relations and commas between them, up to a bracket."""
        parts = []
        while self.token and self.token != closing:
            if self.token in ")]":
                raise NotTypeset(f"{self.token!r} closes nothing")
            if self.token in "+-=,;:<>" or self.token in OPERATORS:
                parts.append(_operator(self.take()))
            else:
                parts.append(self.product(closing))
        return "".join(parts)

    def ends(self, closing: str) -> bool:
        return (
            not self.token
            or self.token in (closing, ")", "]")
            or self.token in "+-=,;:<>/"
            or (self.token in OPERATORS)
        )

    def product(self, closing: str) -> str:
        """Factors side by side, divided where a slash follows."""
        factors = [self.factor(closing)]
        while self.token == "/" or not self.ends(closing):
            if self.token != "/":
                factors.append(self.factor(closing))
                continue
            divided = 0 if self.spaced else len(factors) - 1  # the first factor above the line
            self.take()
            above, below = _bare(SPACE.join(factors[divided:])), _bare(self.factor(closing))
            factors[divided:] = [f"<mfrac>{above}{below}</mfrac>"]
        return f"<mrow>{SPACE.join(factors)}</mrow>"

    def factor(self, closing: str) -> str:
        """A number, name, call or bracket, with its primes and its power."""
        base = self.base(closing)
        if self.token and not self.token.strip("'"):
            base = f"<msup>{base}<mo>{PRIME * len(self.take())}</mo></msup>"
            base = self.called(base)
        if self.token == "^":
            self.take()
            base = f"<msup>{base}{_bare(self.base(closing))}</msup>"
        return base

    def base(self, closing: str) -> str:
        token = self.take()
        if not token:
            raise NotTypeset("something is missing at the end")
        if token in CLOSING and token != closing:
            return self.bracket(token)
        if token[0].isdigit():
            return f"<mn>{token}</mn>"
        if token in FUNCTIONS:
            return self.function(token, closing)
        if token[0].isalpha():
            return self.called(_name(token))
        raise NotTypeset(f"{token!r} is not mathematics")

    def bracket(self, opening: str) -> str:
        inner = self.sequence(CLOSING[opening])
        if self.take() != CLOSING[opening]:
            raise NotTypeset(f"{CLOSING[opening]!r} is missing")
        return f"<mrow><mo>{opening}</mo>{inner}<mo>{CLOSING[opening]}</mo></mrow>"

    def called(self, name: str) -> str:
        """A name with its arguments, where a bracket follows at once."""
        if self.token != "(" or self.spaced:
            return name
        return f"<mrow>{name}{self.bracket(self.take())}</mrow>"

    def function(self, name: str, closing: str) -> str:
        """A function of a bracket, or of the factors up to the next function."""
        if name == "sqrt" and self.token == "(":
            return f"<msqrt>{_bare(self.bracket(self.take()))}</msqrt>"
        shown = "<mo>∑</mo>" if name == "sum" else f"<mi>{name}</mi>"
        if self.token == "^":
            raise NotTypeset("powers of functions are written behind their bracket")
        if self.token == "(" and not self.spaced:
            return f"<mrow>{shown}{self.bracket(self.take())}</mrow>"
        arguments = [SPACE + self.factor(closing)]
        while name != "sum" and not self.ends(closing) and self.token not in {*FUNCTIONS, "(", "["}:
            arguments.append(SPACE + self.factor(closing))
        return f"<mrow>{shown}{''.join(arguments)}</mrow>"


def _operator(token: str) -> str:
    return f"<mo>{OPERATORS.get(token, token)}</mo>"


def _bare(shown: str) -> str:
    """Return a term without the brackets that it needs neither above or below a line nor as a power."""
    inner = re.fullmatch(r"<mrow><mo>\(</mo>(.*)<mo>\)</mo></mrow>", shown)
    depth = 0
    for bracket in re.findall(r"<mo>([()])</mo>", inner[1]) if inner else ")":
        depth += 1 if bracket == "(" else -1
        if depth < 0:  # the first bracket is closed before the end
            return f"<mrow>{shown}</mrow>"
    return f"<mrow>{inner[1] if inner else shown}</mrow>"


def _name(token: str) -> str:
    """A symbol, with what is below it; words and names of variables stand upright."""
    found = re.fullmatch(r"([A-Za-z]|" + "|".join(GREEK) + r")(?:_(\w+)|(\d+))?", token)
    if found is not None:
        symbol = f"<mi>{GREEK.get(found[1], found[1])}</mi>"
        below = found[2] or found[3]
        return f"<msub>{symbol}<mtext>{below}</mtext></msub>" if below else symbol
    return f"<mi>{token}</mi>"
