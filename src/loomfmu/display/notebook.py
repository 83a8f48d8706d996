"""Tables of results in a notebook, in the notebook's own colours, light or dark."""

from collections.abc import Sequence

from .printed import safe

# colours that colour-blind readers tell apart
MARKS = {"holds": ("#009e73", "✓"), "FAILS": ("#d55e00", "✗"), "undecided": ("#e69f00", "?")}
CELL = "text-align:left;padding:.15em .8em .15em 0;vertical-align:top"


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows below headings, all text escaped. Words that stand for a verdict get a mark."""
    head = "".join(f'<th scope="col" style="{CELL}">{text(each)}</th>' for each in headings)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(words: str) -> str:
    mark = ""
    if words in MARKS:
        colour, sign = MARKS[words]
        mark = f'<span style="color:{colour}" aria-hidden="true">{sign}</span> '
    return f'<td style="{CELL}">{mark}{text(words)}</td>'


def text(words: str) -> str:
    """A text as HTML."""
    from html import escape  # most runs are not in a notebook

    return escape(safe(words))


def line(words: str) -> str:
    """A line of text."""
    return f"<div>{text(words)}</div>"


def block(title: str, *parts: str, warnings: Sequence[str] = ()) -> str:
    """Parts, already HTML, below a title, and warnings below them."""
    below = "".join((*parts, *map(line, _warnings(warnings))))
    return f'<div style="overflow-x:auto"><strong>{text(title)}</strong>{below}</div>'


def warned(words: str, warnings: Sequence[str]) -> str:
    """A result in words, with its warnings below it."""
    return "\n".join([words, *_warnings(warnings)])


def _warnings(warnings: Sequence[str]) -> list[str]:
    return [f"warning: {each}" for each in warnings]
