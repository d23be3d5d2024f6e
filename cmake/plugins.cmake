# Registration of plugins by an explicit table: objects that register themselves would be dropped from a static library.

set_property(GLOBAL PROPERTY AEROSOL_PLUGIN_SOURCES)
set_property(GLOBAL PROPERTY AEROSOL_PLUGIN_FUNCTIONS)

# aerosol_plugins(<kind> <name>...): kind is the folder's name, a plural (volumes); functions carry its singular.
function(aerosol_plugins kind)
  string(REGEX REPLACE "s$" "" singular "${kind}")
  string(SUBSTRING "${singular}" 0 1 first)
  string(SUBSTRING "${singular}" 1 -1 rest)
  string(TOUPPER "${first}" first)
  foreach(name ${ARGN})
    set(source "${CMAKE_SOURCE_DIR}/plugins/${kind}/${name}.cpp")
    if(NOT EXISTS "${source}")
      message(FATAL_ERROR "plugins/CMakeLists.txt lists '${name}' under ${kind}, but plugins/${kind}/${name}.cpp does not exist")
    endif()
    set_property(GLOBAL APPEND PROPERTY AEROSOL_PLUGIN_SOURCES "${source}")
    set_property(GLOBAL APPEND PROPERTY AEROSOL_PLUGIN_FUNCTIONS "register${first}${rest}_${name}")
  endforeach()
  file(GLOB present CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/plugins/${kind}/*.cpp")
  foreach(source ${present})
    get_filename_component(name "${source}" NAME_WE)
    if(NOT name IN_LIST ARGN)
      message(WARNING "plugins/${kind}/${name}.cpp is not listed in plugins/CMakeLists.txt and is not compiled")
    endif()
  endforeach()
endfunction()

# aerosol_plugin_library(): the library aerosol_plugins with all listed plugins and the table.
function(aerosol_plugin_library)
  get_property(sources GLOBAL PROPERTY AEROSOL_PLUGIN_SOURCES)
  get_property(functions GLOBAL PROPERTY AEROSOL_PLUGIN_FUNCTIONS)
  if(NOT sources)
    add_library(aerosol_plugins INTERFACE)
    target_link_libraries(aerosol_plugins INTERFACE core_render core_grid)
    return()
  endif()
  set(declarations "")
  set(entries "")
  foreach(name ${functions})
    string(APPEND declarations "void ${name}(Registry& registry);\n")
    string(APPEND entries "    ${name},\n")
  endforeach()
  set(table "${CMAKE_CURRENT_BINARY_DIR}/registration.cpp")
  file(CONFIGURE OUTPUT "${table}" @ONLY CONTENT [[// Generated from plugins/CMakeLists.txt.
#include "plugins/registration.h"

namespace aerosol::render {

@declarations@
namespace {

constexpr void (*table[])(Registry&) = {
@entries@};

}  // namespace

void registerPlugins(Registry& registry) {
  for (const auto entry : table) entry(registry);
}

}  // namespace aerosol::render
]])
  add_library(aerosol_plugins STATIC ${sources} "${table}")
  target_link_libraries(aerosol_plugins PUBLIC core_render core_grid PRIVATE fmt::fmt)
  aerosol_precompile(aerosol_plugins)
endfunction()
