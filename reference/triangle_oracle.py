"""Exact intersection test of two triangles by linear programming over the integers.

It uses no orientation test, plane or case distinction: the triangles intersect if and only if weights u, v >= 0, each
with sum 1, exist such that sum u_i a_i = sum v_i b_i over the corners a_i and b_i.
"""

from collections.abc import Sequence

Triangle = Sequence[Sequence[float]]


def intersects(a: Triangle, b: Triangle) -> bool:
    """Whether two closed triangles have a common point, exact for float64 corners; one corner per row."""
    ratios = [float(x).as_integer_ratio() for row in (*a, *b) for x in row]
    unit = max(denominator for _, denominator in ratios)  # all are powers of two, so it is a multiple of each
    whole = [numerator * (unit // denominator) for numerator, denominator in ratios]
    rows = [[whole[axis], whole[3 + axis], whole[6 + axis], -whole[9 + axis], -whole[12 + axis], -whole[15 + axis], 0]
            for axis in range(3)]
    return feasible([*rows, [1, 1, 1, 0, 0, 0, 1], [0, 0, 0, 1, 1, 1, 1]])


def feasible(rows: list[list[int]]) -> bool:
    """Whether a solution x >= 0 of the linear equations exists; a row holds the coefficients and the right side (>= 0).

    First phase of the simplex method in integers (Edmonds' pivots: all entries over one common divisor). Bland's rule
    ensures termination for any input.
    """
    columns = len(rows[0]) - 1
    basis = [columns + i for i in range(len(rows))]  # one artificial variable per row; minimizes their sum
    cost = [-sum(column) for column in zip(*rows, strict=True)]
    divisor = 1
    while cost[-1] != 0:
        entering = next((j for j in range(columns) if cost[j] < 0), None)
        if entering is None:
            return False
        leaving = -1
        for i, row in enumerate(rows):
            if row[entering] <= 0:
                continue
            if leaving >= 0:
                best = rows[leaving]
                step, least = row[-1] * best[entering], best[-1] * row[entering]
                if step > least or (step == least and basis[i] > basis[leaving]):
                    continue
            leaving = i
        chosen = rows[leaving]
        pivot = chosen[entering]
        for row in [*rows, cost]:
            if row is not chosen:
                factor = row[entering]
                row[:] = [(x * pivot - factor * y) // divisor for x, y in zip(row, chosen, strict=True)]
        divisor = pivot
        basis[leaving] = entering
    return True
