"""What the standard deviation of each dimension is made of."""

from dataclasses import replace

from floorplan.model.error_parts import ErrorParts
from floorplan.model.plan import Dimension


def with_sigma_parts(dimensions: tuple[Dimension, ...], plane_ids: tuple[str, ...], parts: ErrorParts | None) -> tuple[Dimension, ...]:
    """The dimensions with their `sigma_parts`; as they are without `parts`, or where a plane was added by the plan itself."""
    if parts is None:
        return dimensions
    row = {name: k for k, name in enumerate(plane_ids[: parts.covariance_m2.shape[1]])}
    return tuple(
        replace(one, sigma_parts=parts.of_distance(row[one.from_plane], row[one.to_plane], one.sigma_m))
        if one.from_plane in row and one.to_plane in row
        else one
        for one in dimensions
    )
