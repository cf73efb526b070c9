"""What can be computed on an organised grid of points, whatever the sensor: normals, connected components."""
