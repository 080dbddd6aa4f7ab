# cmake -D COMPILER=... -D FLAGS=... -D SOURCE=... -D INCLUDE_DIR=... -D NM=... -D PROGRAM=... -P compile_and_run.cmake

separate_arguments(flags UNIX_COMMAND "${FLAGS}")
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${what} failed (${result}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run("Compiling" "${COMPILER}" -std=c++17 -fno-exceptions -fno-rtti -Wall -Wextra -Wconversion -Wshadow -Werror ${flags}
    "-I${INCLUDE_DIR}" -MD -MF "${PROGRAM}.d" -c "${SOURCE}" -o "${PROGRAM}.o")

# -MD names every header that was read, those of the system too.
file(READ "${PROGRAM}.d" headers)
string(REGEX MATCH "[^ \n]*/(Eigen|boost)/[^ \n]*" stranger "${headers}")
if(stranger)
  message(FATAL_ERROR "phimis::core includes ${stranger}")
endif()

run("Reading the symbols" "${NM}" -u "${PROGRAM}.o")
string(REGEX MATCH "(_Zn[wa]|_Zd[la]|malloc|calloc|realloc|free|__cxa_throw|__cxa_allocate|__cxa_guard)[^\n]*" stranger
             "${output}")
if(stranger)
  message(FATAL_ERROR "phimis::core uses the heap, an exception or a guarded static: ${stranger}")
endif()

run("Linking" "${COMPILER}" ${flags} "${PROGRAM}.o" -o "${PROGRAM}")
run("The program" "${PROGRAM}")
