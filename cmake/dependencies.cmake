# What phimis::phimis needs. The installed package repeats it in phimis-config.cmake.in.

if(POLICY CMP0167) # from CMake 3.30 on, Boost's own package file in place of FindBoost
  cmake_policy(SET CMP0167 NEW)
endif()

# No version here: the version files of Eigen 3.4.0 and 5 refuse ranges and each other's 3.4.
find_package(Eigen3 REQUIRED NO_MODULE)
if(Eigen3_VERSION VERSION_LESS 3.4)
  message(FATAL_ERROR "phimis: Eigen 3.4 or newer is needed; ${Eigen3_DIR} is ${Eigen3_VERSION}")
endif()
find_package(Boost 1.74 REQUIRED)
