# Rules of the tree that are tests: the layers, the format, the shell scripts, an installation that is moved.

find_program(AEROSOL_BASH bash REQUIRED)
find_program(AEROSOL_CLANG_FORMAT NAMES clang-format-19 REQUIRED)

add_test(NAME layers COMMAND "${AEROSOL_BASH}" "${CMAKE_SOURCE_DIR}/tests/layers/check_layers.sh" "${CMAKE_SOURCE_DIR}")
add_test(NAME layers.self_test COMMAND "${AEROSOL_BASH}" "${CMAKE_SOURCE_DIR}/tests/layers/self_test.sh")
add_test(NAME format COMMAND "${AEROSOL_BASH}" "${CMAKE_SOURCE_DIR}/tests/format/check_format.sh" "${CMAKE_SOURCE_DIR}"
                             "${AEROSOL_CLANG_FORMAT}")
set_tests_properties(layers layers.self_test format PROPERTIES LABELS style TIMEOUT 300)

if(TARGET aerosol)
  add_test(NAME install COMMAND "${AEROSOL_BASH}" "${CMAKE_SOURCE_DIR}/tests/install/check_install.sh" "${CMAKE_COMMAND}"
                                "${CMAKE_BINARY_DIR}")
  set_tests_properties(install PROPERTIES LABELS install TIMEOUT 300)

  # tests/app/*_test.sh PROGRAM: the program as a process, from the command line to exit codes and files.
  file(GLOB appTests CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/app/*_test.sh")
  foreach(script ${appTests})
    get_filename_component(name "${script}" NAME_WE)
    add_test(NAME app.${name} COMMAND "${AEROSOL_BASH}" "${script}" $<TARGET_FILE:aerosol>)
    set_tests_properties(app.${name} PROPERTIES LABELS app TIMEOUT 300)
  endforeach()
endif()
