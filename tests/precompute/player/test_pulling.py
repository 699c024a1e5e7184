"""Pulling a tree: the compliance file against the FEM, the hand, and gust fronts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse
from galewood.check.verify.motion_checks import loaded_pole
from galewood.motion.wind import Wind, WindError, WindField, parse_wind_or_state, with_front
from galewood.pipeline.tables.compliance import compliance_of, four_largest, whole_weights
from galewood.player import DragConstraint, PointResponse, PullError, point_response
from galewood.player.pulling import displacement_at, solve, vertex_loads
from galewood.solid.fem import FemModel, TangentFactor, solve_static, tangent_factor
from galewood.table import Compliance, TableError, decode, decode_compliance, encode_compliance

from tests.golden import GOLDEN_FOLDER
from tests.golden.make_pull import NODES, chain_factor, chain_matrix


@pytest.fixture(scope="module")
def model() -> FemModel:
    """A pole with the mass of a crown."""
    return loaded_pole()


@pytest.fixture(scope="module")
def factor(model: FemModel) -> TangentFactor:
    """Its factor."""
    return tangent_factor(model)


def bound(model: FemModel, factor: TangentFactor) -> Compliance:
    """A compliance file whose vertices are the nodes of the model."""
    binding = scipy.sparse.identity(model.vertex_count, format="csr")
    return compliance_of(factor, scipy.sparse.csr_matrix(binding), "0" * 64)


def test_factor_gives_the_tangent_of_the_static_solution(model: FemModel, factor: TangentFactor) -> None:
    """A small force on a node moves all nodes as the nonlinear static solution does."""
    node = int(np.argmax(model.nodes_m[:, 1]))
    load = np.zeros((factor.free, 3))
    load[factor.rank[node], 0] = 1.0
    u = np.concatenate([factor.solve(load), np.zeros((1, 3))])[factor.rank]
    force = 1e-3 / np.abs(u).max()
    system = model.system()
    pulled = model.gravity_n.copy()
    pulled[node, 0] += force
    moved, _, converged = solve_static(system, pulled, tolerance=1e-12)
    rest, _, _ = solve_static(system, model.gravity_n, tolerance=1e-12)
    assert converged
    assert np.abs(moved - rest - force * u).max() < 0.02 * 1e-3


def test_file_in_32_bits_solves_like_the_factor(model: FemModel, factor: TangentFactor) -> None:
    """Encoding and decoding changes the response by less than 1e-4 of its largest displacement."""
    compliance = decode_compliance(encode_compliance(bound(model, factor)))
    for vertex in range(0, model.vertex_count, 7):
        load, _ = vertex_loads(compliance, vertex)
        u = solve(compliance, load[0])
        exact = factor.solve(load[0])
        assert np.abs(u - exact).max() <= 1e-4 * max(np.abs(exact).max(), 1e-12)


def test_response_is_reciprocal(model: FemModel, factor: TangentFactor) -> None:
    """Maxwell and Betti: j moves under a force on i as i does under the same force on j."""
    compliance = bound(model, factor)
    rng = np.random.default_rng(5)
    for first, second in rng.integers(0, model.vertex_count, (5, 2)):
        of_first = solve(compliance, vertex_loads(compliance, int(first))[0][0])
        of_second = solve(compliance, vertex_loads(compliance, int(second))[0][2])
        there = displacement_at(of_first, compliance, int(second))[2]
        back = displacement_at(of_second, compliance, int(first))[0]
        assert there == pytest.approx(back, rel=1e-3, abs=1e-9)


def test_chain_is_solved_exactly() -> None:
    """The factor of the golden chain against a dense solution."""
    factor = chain_factor()
    load = np.random.default_rng(1).normal(size=(NODES, 3))
    u = factor.solve(load[::-1])[::-1]
    assert np.allclose(u.ravel(), np.linalg.solve(chain_matrix(), load.ravel()), rtol=1e-9)


def test_breaking_force_falls_towards_the_tip(model: FemModel, factor: TangentFactor) -> None:
    """A lever is longer at the tip, so less force breaks the cylinder there."""
    height = model.nodes_m[: model.vertex_count, 1]
    free = factor.rank[: model.vertex_count] < factor.free
    limit = factor.limit_n[factor.rank[: model.vertex_count][free]]
    upper = height[free] > np.quantile(height[free], 0.8)
    lower = height[free] < np.quantile(height[free], 0.4)
    assert np.median(limit[upper]) < 0.7 * np.median(limit[lower])


def test_weights_are_whole_and_complete() -> None:
    """Rows with more than four entries keep the largest; the weights sum to 65535."""
    row = scipy.sparse.csr_matrix(np.array([[0.1, 0.2, 0.05, 0.3, 0.35], [0.0, 0.0, 1.0, 0.0, 0.0]]))
    corner, share = four_largest(row)
    assert set(corner[0]) == {0, 1, 3, 4}
    assert share.sum(axis=1) == pytest.approx(1.0)
    assert (whole_weights(share).sum(axis=1) == 65535).all()


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"mass_kg": np.zeros(NODES, np.float32)}, "nodes.mass_kg"),
        ({"limit_n": np.full(NODES, np.nan, np.float32)}, "nodes.limit_n"),
        ({"rows": np.zeros(24, np.uint16)}, "factor.rows"),
        ({"vertex_row": np.full(3, 60000, np.uint32)}, "bind.vertex_row"),
    ],
)
def test_invalid_files_are_refused(change: dict[str, np.ndarray], complaint: str) -> None:
    """The message names the tensor."""
    good = decode_compliance((GOLDEN_FOLDER / "pole-compliance.safetensors").read_bytes())
    with pytest.raises(TableError, match=complaint):
        encode_compliance(replace(good, **change))


def golden_response(vertex: int = 3) -> PointResponse:
    """The response of a point of the golden table."""
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    compliance = decode_compliance((GOLDEN_FOLDER / "pole-compliance.safetensors").read_bytes())
    return point_response(table, vertex, compliance)


def test_hand_moves_its_point_to_the_target() -> None:
    """In the direction in which the point yields most and within its limits, to a few percent."""
    response = golden_response()
    _, axes = np.linalg.eigh(response.compliance)
    target = (
        0.2
        * axes[:, 2]
        * min(response.reach_m, response.limit_n * np.linalg.eigvalsh(response.compliance)[2])
    )
    hand = DragConstraint(response)
    for _ in range(60):
        hand.step(1 / 30, target, np.zeros(3))
    assert np.linalg.norm(response.compliance @ hand.force_n - target) < 0.05 * np.linalg.norm(target)


def test_hand_never_exceeds_its_limits() -> None:
    """However far the target, neither the breaking force nor the reach is exceeded."""
    response = golden_response()
    hand = DragConstraint(response)
    for _ in range(200):
        hand.step(1 / 30, np.array([900.0, -900.0, 900.0]), np.zeros(3))
        assert np.linalg.norm(hand.force_n) <= 1.000001 * response.limit_n
        assert np.linalg.norm(response.compliance @ hand.force_n) <= 1.000001 * response.reach_m


def test_unknown_vertex_is_named() -> None:
    """The error tells how many there are."""
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    with pytest.raises(PullError, match=r"there is no vertex 9999999"):
        point_response(table, 9999999)


def test_front_travels_downwind_and_dies_down() -> None:
    """It is nowhere at first, passes a place downwind once, never reaches one upwind, and ends."""
    field = WindField(Wind(mean_speed_m_s=0.0, direction_deg=90.0))
    field.state = with_front(field.state, 10.0, -5.0, 3.0)
    x, z = np.array([10.0, 10.0, 60.0]), np.array([40.0, -40.0, 40.0])
    out = np.zeros((2, 3))
    speeds = []
    for time_s in np.arange(0.0, 40.0, 0.1):
        field.velocity(x, z, float(time_s), out[0], out[1])
        speeds.append(out[1].copy())
        assert np.abs(out[0]).max() < 1e-9
    felt = np.array(speeds)
    assert felt[:30].max() == 0.0
    assert 2.0 < felt[:, 0].max() < 6.0
    assert felt[:, 1].max() == 0.0
    assert felt[:, 2].max() == 0.0
    assert felt[-100:].max() == 0.0


def test_fronts_survive_a_change_and_are_limited() -> None:
    """A state is parsed as it was written; at most four fronts are kept."""
    state = WindField(Wind()).state
    for k in range(6):
        state = with_front(state, float(k), 0.0, 0.5 * k)
    assert [front.x_m for front in state.fronts] == [2.0, 3.0, 4.0, 5.0]
    assert parse_wind_or_state(state.document()) == state
    document = {**state.document(), "fronts": [{"since_s": 0.0}]}
    with pytest.raises(WindError, match=r"fronts\[0\]\.x_m"):
        parse_wind_or_state(document)
