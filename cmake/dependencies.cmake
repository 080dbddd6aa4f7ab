# What phimis::phimis needs. The installed package repeats it in phimis-config.cmake.in.

if(POLICY CMP0167) # from CMake 3.30 on, Boost's own package file in place of FindBoost
  cmake_policy(SET CMP0167 NEW)
endif()

# No version here: the version files of Eigen 3.4.0 and 5 refuse ranges and each other's 3.4.
find_package(Eigen3 QUIET NO_MODULE)
find_package(Boost 1.74 QUIET)
set(phimis_missing "")
if(NOT Eigen3_FOUND)
  list(APPEND phimis_missing "Eigen 3.4 or newer, which was not found")
elseif(Eigen3_VERSION VERSION_LESS 3.4)
  list(APPEND phimis_missing "Eigen 3.4 or newer; ${Eigen3_DIR} is ${Eigen3_VERSION}")
endif()
if(NOT Boost_FOUND)
  list(APPEND phimis_missing "Boost 1.74 or newer, which was not found")
endif()

# A host that wants phimis::core alone has it without either; on its own the project wants all.
if(phimis_missing)
  list(JOIN phimis_missing ", and " phimis_missing)
  if(PROJECT_IS_TOP_LEVEL)
    message(FATAL_ERROR "phimis: phimis::phimis needs ${phimis_missing}")
  endif()
  message(STATUS "phimis: only phimis::core is defined; phimis::phimis needs ${phimis_missing}")
endif()
