// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_VERSION_HPP
#define PHIMIS_CORE_VERSION_HPP

// The version of the library stands here and nowhere else; the build reads it from this file.
#define PHIMIS_VERSION_MAJOR 0
#define PHIMIS_VERSION_MINOR 1
#define PHIMIS_VERSION_PATCH 0

#endif  // PHIMIS_CORE_VERSION_HPP
