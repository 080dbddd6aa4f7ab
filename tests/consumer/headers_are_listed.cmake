# cmake -P headers_are_listed.cmake: every header under include/ stands in cmake/headers.cmake, and nothing else does.

cmake_path(SET root NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../..")
include("${root}/cmake/headers.cmake")
set(listed ${PHIMIS_CORE_HEADERS} ${PHIMIS_UPPER_HEADERS})
file(GLOB_RECURSE present RELATIVE "${root}/include" "${root}/include/*")

set(missing ${present})
list(REMOVE_ITEM missing ${listed})
set(gone ${listed})
list(REMOVE_ITEM gone ${present})
if(missing)
  list(JOIN missing "\n  " missing)
  message(SEND_ERROR "not listed in cmake/headers.cmake, so not installed:\n  ${missing}")
endif()
if(gone)
  list(JOIN gone "\n  " gone)
  message(SEND_ERROR "listed in cmake/headers.cmake, but not under include/:\n  ${gone}")
endif()
