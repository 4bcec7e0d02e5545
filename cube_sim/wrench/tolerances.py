"""What counts as zero, side by side: each tolerance, what it is a part of, and why it is no larger and no smaller.

Three kinds differ. Whether a weak direction is worth having is a choice about the vehicle (`RANK_TOLERANCE`). Whether a
number is more than rounding is a matter of double precision, of which every operation in between takes its share (the
others). How large a number may be at all is a matter of the squares that follow (`LARGEST`, `SMALLEST`).
"""

RANK_TOLERANCE = 1e-2
"""Gain of a direction below which it does not count unless told otherwise, part of the vehicle's largest gain.

A choice, not rounding: at 1 % the thrusters would have to push a hundred times as hard as in their best direction.
"""

RANK_ROUNDING = 1e-12
"""Gain of a direction below which it never counts, part of the largest gain, however small a tolerance is asked for.

Nothing is divided by such a gain, so it can be nearer to the precision of 2e-16 than `RANK_THRESHOLD`.
"""

RANK_THRESHOLD = 1e-9
"""Singular values below this part of the largest one are rounding, not authority, where forces are computed from them.

Forces are wrenches divided by singular values, so that rounding grows by the inverse: to 1e-7 here, which is well below
a thousandth of a newton. It is near machine precision on purpose. A nearly singular vehicle (thrusters lost, built
imperfectly) keeps its weak direction, and a demand along it that exceeds the limits is answered as unattainable,
exactly.
"""

SAME_SPAN = 1e-10
"""Height of a column of length 1 over the span of others below which it adds no dimension to it.

Columns flatter than this have a common normal that is rounding, so that no facet is read off them. What is a facet of
its own but nearly flat must not be lost, so the value is the smallest of those that can be trusted to 1e-6.
"""

SAME_DIRECTION = 1e-9
"""Difference of two unit vectors in every component below which they are the same facet's normal."""

NO_NEW_DIRECTION = 1e-10
"""Sine of the angle to the active constraints' span below which one more adds no direction (active-set method)."""

PARALLEL, CROSSING = 1e-12, 1e-6
"""Sines of the angle of two lines in the plane of a two-dimensional kernel: parallel up to the first, crossing from the
second on.

The planar search divides by the sine of two lines that cross, so the second is large. A vehicle with a sine between the
two is left to the branch and bound, which divides by none.
"""

NO_GAIN = 1e-12
"""Share of one newton along a facet's normal that counts as none, and of the largest sum of these as rounding."""

NO_SLOPE = 1e-300
"""Change of a wrench along a facet's normal below which a line runs along the facet: what can still be divided by."""

FORCE_ROUNDING = 1e-10
"""Least force that may count as rounding, part of the largest limit: thousands of operations lie before it."""

MATRIX_ROUNDING = 1e-6
"""Force that the rounding of A's entries hides, part of the largest limit.

Matrices are published to seven digits: half a unit of the last one, in some entries of a handful of thrusters whose
levers may be a fifth of a metre.
"""

LARGEST = 1e30
"""Largest number an analysis or an allocator is built from: beyond it, squares of products leave double precision."""

SMALLEST = 1e-30
"""Least size of a matrix that forces are computed from, for the same reason as `LARGEST`."""
