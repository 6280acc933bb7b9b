# SPDX-License-Identifier: Apache-2.0
"""Ranges of whole multiples of 2^-192 that enclose exact numbers; sines, vectors and poses."""
import fractions
import math

S = 192  # numbers are enclosed by whole multiples of 2^-S
ONE = 1 << S


class R:
    """An enclosure: a range of multiples of 2^-S."""
    __slots__ = ("low", "high")

    def __init__(self, low, high=None):
        self.low, self.high = low, low if high is None else high

    @staticmethod
    def of(value):
        exact = fractions.Fraction(value) * ONE
        return R(math.floor(exact), math.ceil(exact))

    def __neg__(self):
        return R(-self.high, -self.low)

    def __add__(self, other):
        return R(self.low + other.low, self.high + other.high)

    def __sub__(self, other):
        return R(self.low - other.high, self.high - other.low)

    def __mul__(self, other):
        all_ = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return R(min(all_) >> S, -(-max(all_) >> S))

    def __truediv__(self, other):
        assert other.low > 0 or other.high < 0
        pairs = [(a << S, b) for a in (self.low, self.high) for b in (other.low, other.high)]
        return R(min(a // b for a, b in pairs), max(-(-a // b) for a, b in pairs))

    def root(self):
        low, high = max(self.low, 0) << S, max(self.high, 0) << S
        return R(math.isqrt(low), math.isqrt(high) + 1)

    def least(self, other):
        return R(min(self.low, other.low), min(self.high, other.high))

    def most(self, other):
        return R(max(self.low, other.low), max(self.high, other.high))

    def absolute(self):
        return R(max(self.low, -self.high, 0), max(-self.low, self.high))


ZERO, UNIT = R(0), R(ONE)


def pi():
    """16 atan(1/5) - 4 atan(1/239), each an alternating series."""
    def atan_inverse(n):
        total, i = fractions.Fraction(0), 0
        while True:
            term = fractions.Fraction(1, (2 * i + 1) * n ** (2 * i + 1))
            if term < fractions.Fraction(1, ONE):
                value = R.of(total)
                return R(value.low - 2, value.high + 2)
            total += term if i % 2 == 0 else -term
            i += 1
    return R.of(16) * atan_inverse(5) - R.of(4) * atan_inverse(239)


PI = pi()


def sine_cosine(angle):
    turns = round(angle / (2 * fractions.Fraction(math.pi)))
    x = R.of(angle) - R.of(2 * turns) * PI
    sums, term, n = [ZERO, ZERO], UNIT, 0  # sums of odd and even powers, signs by n mod 4
    while n < 8 or term.absolute().high > 4:
        sums[n % 2] = sums[n % 2] + term if n % 4 < 2 else sums[n % 2] - term
        n += 1
        term = term * x / R.of(n)
    rest = R(-16, 16)  # terms fall by more than a half from here
    return sums[1] + rest, sums[0] + rest


def sine_of_half(w):
    return UNIT if w >= 3 else sine_cosine(w / 2)[0]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def take(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(k, a):
    return [k * x for x in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turned(rows, p):
    return [dot(row, p) for row in rows]


def transposed(rows):
    return [[rows[j][i] for j in range(3)] for i in range(3)]


def product(a, b):
    columns = transposed(b[0])
    return [[dot(row, column) for column in columns] for row in a[0]], \
        add(turned(a[0], b[1]), a[1])


def inverse(pose):
    """By cofactors, so nothing is assumed of the rows."""
    rows, shift = pose
    cofactors = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])]
    volume = dot(rows[0], cofactors[0])
    back = [[value / volume for value in row] for row in transposed(cofactors)]
    return back, [-x for x in turned(back, shift)]


IDENTITY = ([[UNIT if i == j else ZERO for j in range(3)] for i in range(3)], [ZERO] * 3)
