# The build tree has the layout of an installation, so that files are found the same way in both: bin/,
# lib/aerosol/*.so, lib/aerosol/runtime/*.bc, share/aerosol/{shaders,scenes}. core/base/paths.h looks them up.

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
foreach(folder bin lib/aerosol share/aerosol)
  file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/${folder}")
endforeach()
foreach(folder shaders scenes)
  file(CREATE_LINK "${CMAKE_SOURCE_DIR}/${folder}" "${CMAKE_BINARY_DIR}/share/aerosol/${folder}" SYMBOLIC)
endforeach()

# Everything that a program needs beside itself to run: the modules and the kernels' runtime library.
get_property(modules GLOBAL PROPERTY AEROSOL_MODULES)
add_custom_target(aerosol_support ALL DEPENDS runtime_bitcode example_plugins ${modules})

# The program under the names of OSL's tools, whose options it takes then. A folder of their own, so that they hide no
# real OSL unless it is put on the path.
foreach(tool oslc oslinfo testrender testshade)
  file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/lib/aerosol/osl-tools")
  file(CREATE_LINK "../../../bin/aerosol" "${CMAKE_BINARY_DIR}/lib/aerosol/osl-tools/${tool}" SYMBOLIC)
endforeach()
