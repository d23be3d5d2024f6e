# The examples of native plugins (plugins/sdk/examples), as shared objects and as bitcode, in the folder of the build tree
# that an installation has too. C and C++ as anybody would compile them: none of the program's flags apply.

set(exampleFolder "${CMAKE_BINARY_DIR}/lib/aerosol/plugins")
set(exampleFlags -O2 -Wall -Wextra -I plugins/sdk)
set(exampleFiles)

# aerosol_example(<file> <source> <compiler> <flag>...)
function(aerosol_example file source compiler)
  set(output "${exampleFolder}/${file}")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${exampleFolder}"
    COMMAND "${compiler}" ${exampleFlags} ${ARGN} -o "${output}" "${source}"
    WORKING_DIRECTORY "${CMAKE_SOURCE_DIR}" # Names of sources in the results are relative ones.
    DEPENDS "${CMAKE_SOURCE_DIR}/${source}" "${CMAKE_SOURCE_DIR}/plugins/sdk/aerosol_shader.h"
    COMMENT "Compiling the plugin ${file}"
    VERBATIM)
  set(exampleFiles ${exampleFiles} "${output}" PARENT_SCOPE)
endfunction()

set(examples plugins/sdk/examples)
find_program(AEROSOL_PLUGIN_C_COMPILER NAMES clang-19 REQUIRED)
set(bitcodeFlags -emit-llvm -c -fno-math-errno -fno-exceptions -fno-rtti -fno-vectorize -fno-slp-vectorize -fno-unroll-loops)
aerosol_example(gear.bc "${examples}/gear.cpp" "${AEROSOL_BITCODE_COMPILER}" -std=c++17 ${bitcodeFlags})
aerosol_example(sprinkle.so "${examples}/sprinkle.c" "${AEROSOL_PLUGIN_C_COMPILER}" -std=c11 -shared -fPIC
                -fvisibility=hidden -lm)
add_custom_target(example_plugins ALL DEPENDS ${exampleFiles})
install(FILES ${exampleFiles} DESTINATION lib/aerosol/plugins)
install(DIRECTORY plugins/sdk/examples DESTINATION share/aerosol/plugins)
