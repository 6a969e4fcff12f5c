import numpy as np
import pytest
import torch

from evenroad.errors import InvalidValue
from evenroad.research.network.model import objective_of_sets
from evenroad.research.training.objective import parse_objective


def torch_hickernell(points):
    """Joe's closed form of the rooted discrepancy of one set, all in torch."""
    n, d = points.shape
    single = ((3.0 - points**2) / 2.0).prod(dim=1).sum()
    pairs = (2.0 - torch.maximum(points[:, None], points[None, :])).prod(dim=2).sum()
    return torch.sqrt((4.0 / 3.0) ** d - 2.0 / n * single + pairs / n**2)


@pytest.mark.parametrize(("sets", "n", "d"), [(1, 1, 1), (3, 7, 2), (2, 40, 10)])
def test_the_bridge_agrees_with_torch_through_and_through(sets, n, d):
    given = torch.from_numpy(np.random.default_rng(0).random((sets, n, d)))
    weights = torch.arange(1.0, sets + 1.0, dtype=torch.float64)
    ours, theirs = given.clone().requires_grad_(), given.clone().requires_grad_()
    values = objective_of_sets(ours, parse_objective("hickernell"))
    expected = torch.stack([torch_hickernell(each) for each in theirs])
    np.testing.assert_allclose(values.detach().numpy(), expected.detach().numpy(), rtol=1e-12)
    (weights * values).sum().backward()
    (weights * expected).sum().backward()
    np.testing.assert_allclose(ours.grad.numpy(), theirs.grad.numpy(), rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("text", ["star", "average_squared", "hickernell + 10*riesz"])
def test_the_gradient_is_that_of_finite_differences(text):
    points = torch.from_numpy(np.random.default_rng(1).random((2, 6, 3))).requires_grad_()
    objective = parse_objective(text)
    assert torch.autograd.gradcheck(
        lambda given: objective_of_sets(given, objective), (points,), eps=1e-7, atol=1e-5, rtol=1e-4
    )


def test_float32_upstream_gets_its_gradient_through_the_cast():
    upstream = torch.rand(1, 8, 2, generator=torch.Generator().manual_seed(0)).requires_grad_()
    objective_of_sets(upstream.double(), parse_objective("star")).sum().backward()
    _, gradient = parse_objective("star").with_gradient(upstream.detach().double()[0].numpy())
    np.testing.assert_allclose(upstream.grad[0].numpy(), gradient, rtol=1e-6)


def test_points_that_are_not_finite_stop_before_the_kernel():
    points = torch.full((1, 4, 2), float("nan"), dtype=torch.float64, requires_grad=True)
    with pytest.raises(InvalidValue, match="points became infinite or NaN.*smaller rate"):
        objective_of_sets(points, parse_objective("hickernell"))


def test_a_second_derivative_through_a_function_of_the_loss_is_refused():
    points = torch.rand(
        1, 4, 2, dtype=torch.float64, generator=torch.Generator().manual_seed(0)
    ).requires_grad_()
    (slope,) = torch.autograd.grad(
        objective_of_sets(points, parse_objective("star")).square().sum(), points, create_graph=True
    )
    with pytest.raises(RuntimeError, match="once_differentiable"):
        slope.sum().backward()
