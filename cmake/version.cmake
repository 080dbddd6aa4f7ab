# PHIMIS_VERSION, read from the one header that states it.

file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../include/phimis/core/version.hpp" phimis_version_lines
     REGEX "^#define PHIMIS_VERSION_(MAJOR|MINOR|PATCH) [0-9]+$")
list(TRANSFORM phimis_version_lines REPLACE "^.* ([0-9]+)$" "\\1")
list(JOIN phimis_version_lines "." PHIMIS_VERSION)
if(NOT PHIMIS_VERSION MATCHES "^[0-9]+\\.[0-9]+\\.[0-9]+$")
  message(FATAL_ERROR "phimis: no version in include/phimis/core/version.hpp (read '${PHIMIS_VERSION}')")
endif()
