"""What the scan itself shows of its errors: sigmas of tracks, the odometry's drift, the depth's bias."""
