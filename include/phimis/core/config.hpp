// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_CONFIG_HPP
#define PHIMIS_CORE_CONFIG_HPP

/// Marks every function of core for the device as well, where a device compiler reads it.
#if defined(__CUDACC__) || defined(__HIPCC__) || defined(__HIP__)
#define PHIMIS_HOST_DEVICE __host__ __device__
#else
#define PHIMIS_HOST_DEVICE
#endif

/// Checks what a function on a hot path requires of its caller. A host may define it before the first include, to
/// its own assertion or to nothing; by default it is `assert`.
#ifndef PHIMIS_EXPECTS
#include <cassert>
#define PHIMIS_EXPECTS(condition) assert(condition)
#endif

#endif  // PHIMIS_CORE_CONFIG_HPP
