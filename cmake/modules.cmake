# Modules: shared objects opened at first use, because loading what they link takes longer than compiling a shader.

# aerosol_module(<name> <folder> <library>...): lib/aerosol/<name>.so from <folder>/*.cpp. Each links its own copy of the
# base layer and shares only C functions and abstract classes with the program.
set_property(GLOBAL PROPERTY AEROSOL_MODULES)
function(aerosol_module name folder)
  file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/${folder}/*.cpp")
  if(NOT sources)
    return()
  endif()
  add_library(${name} MODULE ${sources})
  target_link_libraries(${name} PRIVATE aerosol_flags core_base fmt::fmt ${ARGN})
  set_target_properties(${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib/aerosol")
  set_property(GLOBAL APPEND PROPERTY AEROSOL_MODULES ${name})
endfunction()

aerosol_module(aerosol_preprocessor core/lang/preprocessor aerosol_clang)
aerosol_module(aerosol_image core/image/module PkgConfig::OpenImageIO PkgConfig::OpenColorIO)
aerosol_module(aerosol_grid core/grid/module aerosol_openvdb)
if(TARGET aerosol_preprocessor)
  set_target_properties(aerosol_preprocessor PROPERTIES JOB_POOL_COMPILE llvm)
endif()
