"""Block Cholesky compared with dense linear algebra."""

import numpy as np
import pytest
from galewood.solid.fem.solver import BlockCholesky, NotPositiveDefinite


def _problem(n: int, seed: int) -> tuple[BlockCholesky, np.ndarray]:
    """A random sparse symmetric positive definite matrix in the solver's pattern."""
    print(f"seed {seed}")
    rng = np.random.default_rng(seed)
    tree = np.column_stack([np.arange(1, n), rng.integers(0, np.arange(1, n))])
    extra = rng.integers(0, n, (n // 2, 2))
    pairs = np.sort(np.concatenate([tree, extra[extra[:, 0] != extra[:, 1]]]), axis=1)
    pairs = np.unique(pairs, axis=0).astype(np.int32)
    solver = BlockCholesky(n, pairs)
    values = np.zeros((solver.blocks, 9))
    ends = solver.rank[pairs]
    values[solver.slots(ends.max(axis=1), ends.min(axis=1))] = rng.normal(size=(len(pairs), 9))
    values[solver.pointer[:-1]] = (np.eye(3) * 30).ravel()
    return solver, values


@pytest.mark.parametrize("seed", range(5))
def test_solution_agrees_with_dense_algebra(seed: int) -> None:
    solver, values = _problem(60, seed)
    matrix = solver.to_scipy(values).toarray()
    np.testing.assert_allclose(matrix, matrix.T)
    b = np.random.default_rng(seed).normal(size=(60, 3))
    x = b.copy()
    solver.factorise(values)
    solver.solve(x)
    np.testing.assert_allclose(matrix @ x.ravel(), b.ravel(), atol=1e-10)


def test_right_hand_sides_side_by_side_are_solved_like_one_after_the_other() -> None:
    solver, values = _problem(60, 7)
    solver.factorise(values)
    b = np.random.default_rng(7).normal(size=(61, 3, 5))
    expected = b.copy()
    for k in range(b.shape[2]):
        one = b[:, :, k].copy()
        solver.solve(one)
        expected[:, :, k] = one
    solver.solve_all(b)
    np.testing.assert_allclose(b, expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_pattern_of_the_factor_is_that_of_elimination(seed: int) -> None:
    solver, values = _problem(60, seed)
    filled = solver.to_scipy(np.ones_like(values)).toarray()[::3, ::3] != 0
    for k in range(solver.n):
        below = np.flatnonzero(filled[:, k])
        below = below[below > k]
        filled[np.ix_(below, below)] = True
        start, end = solver.pointer[k : k + 2]
        np.testing.assert_array_equal(solver.rows[start:end], [k, *below])


def test_factorisation_is_deterministic() -> None:
    answers = []
    for _ in range(2):
        solver, values = _problem(80, 3)
        x = np.ones((80, 3))
        solver.factorise(values)
        solver.solve(x)
        answers.append(x.tobytes())
    assert answers[0] == answers[1]


def test_indefinite_matrix_is_rejected() -> None:
    solver, values = _problem(20, 0)
    values[solver.pointer[7], 4] = -1.0
    with pytest.raises(NotPositiveDefinite):
        solver.factorise(values)


def test_nan_is_rejected() -> None:
    solver, values = _problem(20, 0)
    values[solver.pointer[3], 0] = np.nan
    with pytest.raises(NotPositiveDefinite):
        solver.factorise(values)


def test_block_outside_the_pattern_is_rejected() -> None:
    solver = BlockCholesky(3, np.array([[0, 1]], np.int32))
    apart = np.sort(solver.rank[[0, 2]])
    with pytest.raises(KeyError):
        solver.slots(apart[1:], apart[:1])


def test_chain_has_no_fill_in() -> None:
    n = 200
    solver = BlockCholesky(n, np.column_stack([np.arange(n - 1), np.arange(1, n)]).astype(np.int32))
    assert solver.blocks == 2 * n - 1
