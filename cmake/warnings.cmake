# Warnings for the project's own executables; no consumer ever links this target.

add_library(phimis_warnings INTERFACE)
target_compile_options(
  phimis_warnings
  INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-Wall;-Wextra;-Wconversion;-Wshadow>
            $<$<CXX_COMPILER_ID:MSVC>:/W4>)
if(PHIMIS_WARNINGS_AS_ERRORS)
  target_compile_options(phimis_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-Werror>
                                                   $<$<CXX_COMPILER_ID:MSVC>:/WX>)
endif()
