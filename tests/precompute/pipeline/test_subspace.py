"""Reduced coordinates: exact for low-rank motion, otherwise optimal; quantised without drift."""

import numpy as np
from galewood.pipeline.reduction.pod import fit_subspace, quantise, thinned


def motion(seed: int, frames: int = 60, n: int = 40, rank: int = 5) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    shapes = rng.normal(size=(rank, 3 * n)) * 0.5 ** np.arange(rank)[:, None]
    return rng.normal(size=(frames, rank)) @ shapes, rng.uniform(0.5, 2.0, n)


def test_low_rank_motion_is_reproduced_exactly() -> None:
    snapshots, mass = motion(1)
    space = fit_subspace(snapshots, mass, 8)
    assert space.modes == 5
    u = snapshots.reshape(60, -1, 3)
    assert np.allclose(space.expand(space.project(u)), u, atol=1e-10)
    assert np.isclose(np.linalg.norm(space.basis, axis=1).max(axis=0), 1.0).all()


def test_modes_are_mass_orthogonal_and_the_reported_error_is_correct() -> None:
    snapshots, mass = motion(2)
    space = fit_subspace(snapshots, mass, 3)
    gram = np.einsum("nik,n,nil->kl", space.basis, mass, space.basis)
    assert np.allclose(gram, np.diag(np.diag(gram)), atol=1e-9 * gram.max())
    u = snapshots.reshape(60, -1, 3)
    error = np.linalg.norm(space.expand(space.project(u)) - u, axis=2).max()
    assert np.isclose(error, space.max_error_m)
    assert space.modes == 3


def test_the_basis_is_optimal_for_its_size() -> None:
    snapshots, mass = motion(3)
    space = fit_subspace(snapshots, mass, 2)
    weighted = snapshots * np.sqrt(np.repeat(mass, 3))
    singular = np.linalg.svd(weighted, compute_uv=False)
    assert np.isclose(space.energy_left, (singular[2:] ** 2).sum() / (singular**2).sum())


def test_quantised_increments_add_up_without_drift() -> None:
    rng = np.random.default_rng(4)
    tracks = [np.cumsum(rng.normal(size=(80, 4)), axis=0) * 0.01 for _ in range(3)]
    tracks = [track - track[0] for track in tracks]
    quantised = quantise(tracks)
    scale = float(quantised.scale[0])
    for k, track in enumerate(tracks):
        sums = np.cumsum(quantised.dq[79 * k : 79 * (k + 1)], axis=0) * scale
        assert np.abs(sums - track[1:]).max() <= 0.5001 * scale


def test_snapshots_are_thinned_evenly() -> None:
    runs = [np.zeros((181, 4, 3)), np.ones((4000, 4, 3))]
    assert 500 < len(thinned(runs)) <= 602
