"""The figures of `make verdicts` and `make attack`, and the criteria of the report."""

from validation.calls import table


def grouped(count: float) -> str:
    """Return a count with its thousands apart."""
    return f"{int(count):,}"


def total(name: str, column: str) -> str:
    """Sum of a column of a table."""
    return grouped(sum(int(row[column]) for row in table(name)))


def sentence() -> str:
    """The figures on verdicts in one sentence, as the documents have it."""
    counts = {name: int(count) for name, count in table("verdicts")[-1].items() if count.isdecimal()}
    said = {name: f"{count:,}" if count else "none" for name, count in counts.items()}
    wrong = counts["false_holds"] + counts["false_fails"]
    verdicts = f"Of {said['verdicts']} verdicts on {said['scenes']} random scenes "
    if wrong:
        verdicts += f'{wrong} {_is(wrong)} wrong, {said["false_holds"]} of them a false "holds" and'
        verdicts += f" {said['wrong_from_1440']} with 1440 steps in a revolution or more"
    else:
        verdicts += "none is wrong"
    small = counts["too_small"]
    return f"{verdicts}, and {said['too_small']} of {said['errors']} errors {_is(small)} too small."


def _is(count: int) -> str:
    return "are" if count > 1 else "is"


def share(criterion: str) -> float:
    """Share of a published number within which its criterion is met."""
    return next(float(row["share"]) for row in table("criteria") if row["criterion"] == criterion)
