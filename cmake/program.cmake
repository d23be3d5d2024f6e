# The command line: core/app/main.cpp is the executable, the rest of core/app a library that tests can call.

aerosol_layer(app PUBLIC aerosol_plugins core_render core_grid PRIVATE fmt::fmt CLI11::CLI11 EXCLUDE "main\\.cpp")
get_target_property(appType core_app TYPE)
if(appType STREQUAL "STATIC_LIBRARY")
  target_compile_definitions(core_app PRIVATE AEROSOL_VERSION="${PROJECT_VERSION}")
endif()
file(GLOB mainSource CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/app/main.cpp")
if(mainSource)
  add_executable(aerosol ${mainSource})
  target_link_libraries(aerosol PRIVATE core_app fmt::fmt)
  add_dependencies(aerosol aerosol_support)
endif()
