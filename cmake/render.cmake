# phimis_render: what the examples that render, and their tests, need beside the library. Random123 is headers alone.
# Where something is missing there is no phimis_render, and they are left out.

find_package(PNG QUIET)
find_package(OpenEXR CONFIG QUIET)
find_package(Threads REQUIRED)
find_path(PHIMIS_RANDOM123 Random123/philox.h)

set(missing "")
if(NOT TARGET PNG::PNG)
  list(APPEND missing "libpng (libpng-dev)")
endif()
if(NOT TARGET OpenEXR::OpenEXR)
  list(APPEND missing "OpenEXR 3 (libopenexr-dev)")
endif()
if(NOT PHIMIS_RANDOM123)
  list(APPEND missing "Random123 (librandom123-dev)")
endif()
if(missing)
  list(JOIN missing ", " missing)
  message(STATUS "phimis: without the examples that render, and their tests; not found: ${missing}")
  return()
endif()

add_library(phimis_render INTERFACE)
target_link_libraries(phimis_render INTERFACE phimis::phimis PNG::PNG OpenEXR::OpenEXR Threads::Threads)
target_include_directories(phimis_render SYSTEM INTERFACE "${PHIMIS_RANDOM123}")

# phimis_environment: what tracing rays through meshes and reading maps needs beyond that.

find_package(embree 3 QUIET)
find_package(assimp CONFIG QUIET)
find_path(PHIMIS_STB stb/stb_image.h)

set(missing "")
if(NOT embree_FOUND)
  list(APPEND missing "Embree 3 (libembree-dev)")
endif()
if(NOT assimp_FOUND)
  list(APPEND missing "assimp (libassimp-dev)")
endif()
if(NOT PHIMIS_STB)
  list(APPEND missing "stb (libstb-dev)")
endif()
if(missing)
  list(JOIN missing ", " missing)
  message(STATUS "phimis: without examples/environment_lighting and its tests; not found: ${missing}")
  return()
endif()

add_library(phimis_environment INTERFACE)
target_link_libraries(phimis_environment INTERFACE phimis_render embree assimp::assimp)
target_include_directories(phimis_environment SYSTEM INTERFACE "${PHIMIS_STB}")
