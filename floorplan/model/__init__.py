"""The words of the method, then the values that pass between stages.

frame               one depth image or laser sweep with its stamp, odometry pose and gravity
Manhattan frame     `R_i`, the rotation from the sensor to the axis-aligned world
entropy compass     the published yaw estimator: the yaw at which the points' projections are least entropic
layout segment      a planar, axis-aligned patch seen in one frame: axis, facing, signed distance, extents
facing              the direction a surface looks; the two faces of one wall face opposite ways
track               segments of consecutive frames that are one plane; an "initial layout plane"
layout plane        an infinite axis-aligned plane with one parameter `m`; segments lie on it
measurement         `m_j - p_i = d_ij`: signed distance along the axis from frame i to plane j
odometry row        `p_{i+1} - p_i = t_i`, with `t_i` in the axis-aligned world
equivalence hypothesis   `m_a - m_b = 0`: two planes may be the same one; a row of `E`
re-solve            least squares again with the accepted equivalences as hard equalities

Values are frozen dataclasses; arrays in them are read-only and their shapes and dtypes are checked once, at
construction. Distances are in metres, angles in radians, unless a name says otherwise; rotations are named `to_from`.
"""
