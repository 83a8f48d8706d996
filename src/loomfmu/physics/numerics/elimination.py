"""Linear equations of any number, by elimination."""


def eliminated(a: list[float], b: list[float]) -> list[float]:
    """Solution x of `a x = b`, where a is symmetric and positive definite, given row by row.

    >>> eliminated([4.0, 2.0, 2.0, 2.0], [8.0, 6.0])
    [1.0, 2.0]
    """
    n = len(b)
    left = list(a)
    x = list(b)
    for pivot in range(n):
        for row in range(pivot + 1, n):
            factor = left[n * row + pivot] / left[n * pivot + pivot]
            for column in range(pivot, n):
                left[n * row + column] = left[n * row + column] - factor * left[n * pivot + column]
            x[row] = x[row] - factor * x[pivot]
    for back in range(n):
        row = n - 1 - back
        for column in range(row + 1, n):
            x[row] = x[row] - left[n * row + column] * x[column]
        x[row] = x[row] / left[n * row + row]
    return x
