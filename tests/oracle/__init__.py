"""The oracle: theory.md in plain float64 NumPy, clarity over speed, to hold the kernels against.

Written from theory.md and the papers, and not from the kernels: microfacet terms are angles and tangents here, densities
are products over splits of area densities, rays try every triangle, tangents are exact derivatives of whole paths (complex
steps), and Q is formed and factored. Everything is batched over paths of one length and ending; node index i runs from 0
(the camera) to K as in theory.md.

Only conventions are shared with the kernels, since numbers cannot be compared without them: the order of coordinates, the
first frame (any_tangent), the widths and axes that constraints.cl documents, the order in which random numbers are used,
and that segments within the offset of rays of a surface count for nothing.

Of the settings, ``differentials="reduced"`` and ``math`` are approximations by the kernels and have no counterpart here.

Functions whose arguments may be complex take derivatives by complex steps (tangents.py): they hold no abs, no norm and no
conjugate; comparisons look at real parts, which come first in NumPy's order of complex numbers.
"""
