# phimis_catch: Catch2 with its main, 2.13 or 3.x. PHIMIS_CATCH_ARGUMENTS: an empty selection of tests is a failure.

find_package(Catch2)
if(NOT Catch2_FOUND)
  message(FATAL_ERROR "phimis: Catch2 was not found. Install it (Debian, Ubuntu: apt-get install catch2), or configure"
                      " with -D PHIMIS_BUILD_TESTS=OFF")
endif()
if(Catch2_VERSION VERSION_LESS 2.13)
  message(FATAL_ERROR "phimis: Catch2 2.13 or newer is needed; ${Catch2_DIR} is ${Catch2_VERSION}")
endif()

if(TARGET Catch2::Catch2WithMain)
  add_library(phimis_catch INTERFACE)
  target_link_libraries(phimis_catch INTERFACE Catch2::Catch2WithMain)
else()
  add_library(phimis_catch STATIC catch_main.cpp)
  target_link_libraries(phimis_catch PUBLIC Catch2::Catch2)
  target_compile_features(phimis_catch PRIVATE cxx_std_17)
endif()

if(Catch2_VERSION VERSION_LESS 3)
  set(PHIMIS_CATCH_ARGUMENTS --filenames-as-tags --warn NoTests)
else()
  set(PHIMIS_CATCH_ARGUMENTS --filenames-as-tags)
endif()
