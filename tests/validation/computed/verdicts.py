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
    of_all = {name: int(count) for name, count in table("verdicts")[-1].items() if count.isdecimal()}
    shown = {name: f"{count:,}" if count else "none" for name, count in of_all.items()}
    wrong = of_all["false_holds"] + of_all["false_fails"]
    verb = "is" if of_all["too_small"] == 1 else "are"
    return (
        f"Of {shown['verdicts']} verdicts on {shown['scenes']} random scenes {wrong or 'none'} are wrong,"
        f' {shown["false_holds"]} of them a false "holds" and {shown["wrong_from_1440"]} with 1440 steps in'
        f" a revolution or more; {shown['too_small']} of {shown['errors']} errors {verb} too small."
    )


def share(criterion: str) -> float:
    """Share of a published number within which its criterion is met."""
    return next(float(row["share"]) for row in table("criteria") if row["criterion"] == criterion)
