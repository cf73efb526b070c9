"""The trajectory eliminated exactly: chains of frames bordered by planes, least squares in the planes alone, their joint covariance."""
