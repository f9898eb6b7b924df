"""Exact confidence intervals for rates (Poisson; Garwood 1936) and for ratios (binomial; Clopper and Pearson 1934).

An exact interval covers the true value with a probability of at least `level`, however few events there are.
"""
import math

LEVEL = 0.95
_STEPS, _SMALL = 10000, 1e-15


def poisson_rate(events, exposure, level=LEVEL):
    """(low, high) of the rate of events in one unit of `exposure`; None without exposure."""
    if exposure <= 0:
        return None
    tail = 0.5 * (1.0 - level)
    # P(N >= events) = tail at the low end, P(N <= events) = tail at the high end
    low = 0.0 if events == 0 else _root(lambda mean: _gamma_below(events, mean) - tail, events)
    high = _root(lambda mean: tail - (1.0 - _gamma_below(events + 1, mean)), events + 1)
    return low / exposure, high / exposure


def clopper_pearson(part, whole, level=LEVEL):
    """(low, high) of a ratio; None for 0 of 0."""
    if whole == 0:
        return None
    tail = 0.5 * (1.0 - level)
    low = 0.0 if part == 0 else _bisect(lambda p: _beta_below(part, whole - part + 1, p) - tail, 0.0, 1.0)
    high = 1.0 if part == whole else _bisect(lambda p: tail - (1.0 - _beta_below(part + 1, whole - part, p)), 0.0, 1.0)
    return low, high


def _root(rising, guess):
    high = max(1.0, 2.0 * guess)
    while rising(high) < 0:
        high *= 2.0
    return _bisect(rising, 0.0, high)


def _bisect(rising, low, high):
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if rising(middle) < 0:
            low = middle
        else:
            high = middle


def _gamma_below(a, x):
    """Regularised lower incomplete gamma function: the series below a + 1, else 1 - the continued fraction (Lentz)."""
    if x <= 0:
        return 0.0
    scale = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x < a + 1:
        term = total = 1.0 / a
        for n in range(1, _STEPS):
            term *= x / (a + n)
            total += term
            if term < _SMALL * total:
                break
        return min(1.0, scale * total)
    b = x + 1.0 - a
    c, d = 1e300, 1.0 / b
    fraction = d
    for n in range(1, _STEPS):
        factor = -n * (n - a)
        b += 2.0
        d = 1.0 / (factor * d + b)
        c = b + factor / c
        fraction *= d * c
        if abs(d * c - 1.0) < _SMALL:
            break
    return max(0.0, 1.0 - scale * fraction)


def _beta_below(a, b, x):
    """Regularised incomplete beta function, by its continued fraction (Lentz)."""
    if x <= 0:
        return 0.0
    if x >= 1:
        return 1.0
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - _beta_below(b, a, 1.0 - x)
    scale = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    c, d = 1.0, 1.0 / (1.0 - (a + b) * x / (a + 1.0))
    fraction = d
    for m in range(1, _STEPS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        d = 1.0 / (1.0 + even * d)
        c = 1.0 + even / c
        fraction *= d * c
        d = 1.0 / (1.0 + odd * d)
        c = 1.0 + odd / c
        fraction *= d * c
        if abs(d * c - 1.0) < _SMALL:
            break
    return scale * fraction
