"""Whether two triangles share a point, in rational arithmetic, by linear programming.

It knows no orientation, no plane and no case: the triangles meet if and only if weights u, v >= 0 with sum 1 each exist
for which the corners' means agree, sum u_i a_i = sum v_i b_i.
"""

from collections.abc import Sequence

Triangle = Sequence[Sequence[float]]


def meet(a: Triangle, b: Triangle) -> bool:
    """Exact for the float64 corners given; a corner a row."""
    ratios = [float(x).as_integer_ratio() for row in (*a, *b) for x in row]
    unit = max(denominator for _, denominator in ratios)  # all are powers of two, so this is a multiple of each
    whole = [numerator * (unit // denominator) for numerator, denominator in ratios]
    rows = [[whole[axis], whole[3 + axis], whole[6 + axis], -whole[9 + axis], -whole[12 + axis], -whole[15 + axis], 0]
            for axis in range(3)]
    return feasible([*rows, [1, 1, 1, 0, 0, 0, 1], [0, 0, 0, 1, 1, 1, 1]])


def feasible(rows: list[list[int]]) -> bool:
    """Whether x >= 0 exists that solves the equations; a row holds the coefficients and the right side, which is >= 0.

    The first phase of the simplex method, integers throughout (Edmonds' pivots: entries over one common divisor),
    with Bland's rule, so that it ends whatever the input.
    """
    columns = len(rows[0]) - 1
    basis = [columns + i for i in range(len(rows))]  # one artificial variable a row; their sum is to become 0
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
