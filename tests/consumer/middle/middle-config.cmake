include(CMakeFindDependencyMacro)
find_dependency(phimis)
include("${CMAKE_CURRENT_LIST_DIR}/middle-targets.cmake")
