# phimis_check(program...): the target `check`, which runs each program; a program that returns nonzero fails it.
function(phimis_check)
  add_custom_target(check)
  foreach(program IN LISTS ARGN)
    add_custom_command(TARGET check POST_BUILD COMMAND ${program} VERBATIM)
  endforeach()
endfunction()
