"""What a range sensor gets wrong in the same way all scan long: no residual shows it, so its size is stated, per kind of sensor.

A scale error stretches building and trajectory together; a bias moves every surface, and how far depends on where in the
image and from which range it was mostly seen (ripple and fixed pattern of time-of-flight cameras).
"""

from dataclasses import replace

import numpy as np

from floorplan.model.error_parts import ErrorCause
from floorplan.model.graph import LayoutGraph, LayoutSolution
from floorplan.model.scan import RangeAccuracy, Sensor, SensorKind

# Cameras: data sheets of time-of-flight and stereo modules promise 1 % of the range, taken as two sigma; wiggling errors of calibrated
# time-of-flight cameras are a few millimetres (Foix, Alenya & Torras 2011, IEEE Sensors J. 11). Scanners measure time with a quartz:
# their scale is good to 0.1 %, their zero to millimetres (LMS 200: Ye & Borenstein 2002).
TYPICAL = {
    SensorKind.CAMERA: RangeAccuracy(scale_sigma=0.005, bias_sigma_m=0.004),
    SensorKind.LASER: RangeAccuracy(scale_sigma=0.001, bias_sigma_m=0.005),
    SensorKind.LIDAR: RangeAccuracy(scale_sigma=0.001, bias_sigma_m=0.005),
}


def range_accuracy(sensor: Sensor) -> RangeAccuracy:
    """What the recording says of its sensor, else what is typical of its kind."""
    return TYPICAL[sensor.kind] if sensor.accuracy is None else sensor.accuracy


def with_range_errors(solution: LayoutSolution, graph: LayoutGraph) -> LayoutSolution:
    """The solution whose standard deviations and covariance contain the accuracy of the graph's sensor (E11).

    A scale error of part k moves every plane by k times its offset (odometry's own scale is free, so nothing holds against it).
    """
    accuracy = graph.range_accuracy
    if accuracy is None:
        return solution
    variance = solution.plane_sigma_m**2 + accuracy.bias_sigma_m**2 + (accuracy.scale_sigma * solution.plane_offset_m) ** 2
    covariance, parts = solution.plane_covariance_m2, solution.error_parts
    if covariance is not None:
        same_axis = solution.plane_axis[:, None] == solution.plane_axis[None, :]
        stretched = accuracy.scale_sigma**2 * np.outer(solution.plane_offset_m, solution.plane_offset_m) * same_axis
        biased = accuracy.bias_sigma_m**2 * np.eye(len(same_axis))
        covariance = covariance + stretched + biased
        if parts is not None:
            parts = parts.with_added(ErrorCause.SCALE, stretched).with_added(ErrorCause.SENSOR, biased)
    return replace(solution, plane_sigma_m=np.sqrt(variance), plane_covariance_m2=covariance, error_parts=parts)
