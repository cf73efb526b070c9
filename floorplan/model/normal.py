"""Factors of the normal distribution that intervals and robust spreads rest on."""

NORMAL_95 = 1.96  # two-sided 95 % interval, in standard deviations
MAD_TO_SIGMA = 1.4826  # standard deviation over the median absolute deviation
