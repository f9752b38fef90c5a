// How every kernel that traces paths is declared.
#ifndef PYLMC_PATH_KERNEL
#define PYLMC_PATH_KERNEL

// Work-items go their own ways through the tree; the hint keeps compilers from running several side by side. It is needed for
// more than speed: Intel's CPU compiler, left to itself, loses occlusions here (tests/claims/test_devices_agree.py).
#define PATH_KERNEL __kernel __attribute__((vec_type_hint(float8)))

#endif
