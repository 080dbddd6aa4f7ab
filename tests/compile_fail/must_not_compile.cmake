# cmake -D COMPILER=... -D SOURCE=... -D INCLUDE_DIRS=... -P must_not_compile.cmake

file(STRINGS "${SOURCE}" expect REGEX "^// expect: ")
string(REGEX REPLACE "^// expect: " "" expect "${expect}")
if(expect STREQUAL "")
  message(FATAL_ERROR "${SOURCE} has no line '// expect: <regular expression>'")
endif()

list(TRANSFORM INCLUDE_DIRS PREPEND "-I")
execute_process(COMMAND "${COMPILER}" -std=c++20 -fsyntax-only ${INCLUDE_DIRS} "${SOURCE}" RESULT_VARIABLE result
                OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0)
  message(FATAL_ERROR "${SOURCE} compiles; it must fail with '${expect}'")
endif()
# Compilers quote names with the marks of the locale, and the source line itself must not count as its message.
string(REGEX REPLACE "// expect: [^\n]*" "" output "${output}")
if(NOT output MATCHES "${expect}")
  message(FATAL_ERROR "${SOURCE} fails, but not with '${expect}':\n${output}")
endif()
