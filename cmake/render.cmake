# phimis_render: what the examples that render, and their tests, need beside the library. Random123 is headers alone.

find_package(PNG)
find_package(OpenEXR CONFIG)
find_package(Threads REQUIRED)
find_path(PHIMIS_RANDOM123 Random123/philox.h)

set(missing "")
if(NOT TARGET PNG::PNG)
  string(APPEND missing " libpng-dev")
endif()
if(NOT TARGET OpenEXR::OpenEXR)
  string(APPEND missing " libopenexr-dev")
endif()
if(NOT PHIMIS_RANDOM123)
  string(APPEND missing " librandom123-dev")
endif()
if(missing)
  message(FATAL_ERROR "phimis: the examples that render need libpng, OpenEXR 3 and Random123. Install what is missing"
                      " (Debian, Ubuntu: apt-get install${missing}), or configure with -D PHIMIS_BUILD_EXAMPLES=OFF"
                      " -D PHIMIS_BUILD_TESTS=OFF")
endif()

add_library(phimis_render INTERFACE)
target_link_libraries(phimis_render INTERFACE phimis::phimis PNG::PNG OpenEXR::OpenEXR Threads::Threads)
target_include_directories(phimis_render SYSTEM INTERFACE "${PHIMIS_RANDOM123}")
