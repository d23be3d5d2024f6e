# The layers of the program, a static library core_<layer> each. Arrows go one way; tests/layers checks the includes.

# aerosol_layer(<name> [PUBLIC <layer>...] [PRIVATE <library>...] [EXCLUDE <regex>])
# A folder without sources gives an interface library, so that headers alone are a layer too.
function(aerosol_layer name)
  cmake_parse_arguments(PARSE_ARGV 1 layer "" "EXCLUDE" "PUBLIC;PRIVATE")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/${name}/*.cpp")
  if(layer_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX "/core/${name}/${layer_EXCLUDE}")
  endif()
  if(sources)
    add_library(core_${name} STATIC ${sources})
    target_link_libraries(core_${name} PUBLIC aerosol_flags ${layer_PUBLIC} PRIVATE ${layer_PRIVATE})
    if(NOT name STREQUAL "jit")  # Has one of its own, below.
      aerosol_precompile(core_${name})
    endif()
  else()
    add_library(core_${name} INTERFACE)
    target_link_libraries(core_${name} INTERFACE aerosol_flags ${layer_PUBLIC} ${layer_PRIVATE})
  endif()
endfunction()

aerosol_layer(base PUBLIC PkgConfig::Imath Threads::Threads PRIVATE fmt::fmt PkgConfig::xxhash ${CMAKE_DL_LIBS})
aerosol_layer(lang PUBLIC core_base PRIVATE fmt::fmt EXCLUDE "preprocessor/")
aerosol_layer(jit PUBLIC core_lang PRIVATE fmt::fmt aerosol_llvm EXCLUDE "runtime/")
aerosol_layer(shading PUBLIC core_jit PRIVATE fmt::fmt)
aerosol_layer(volume PUBLIC core_shading PRIVATE fmt::fmt)

aerosol_layer(scene PUBLIC core_base PRIVATE fmt::fmt pugixml::pugixml)
aerosol_layer(accel PUBLIC core_base PRIVATE fmt::fmt aerosol_embree ZLIB::ZLIB)
aerosol_layer(image PUBLIC core_base PRIVATE fmt::fmt EXCLUDE "module/")
aerosol_layer(grid PUBLIC core_base PRIVATE fmt::fmt EXCLUDE "module/")

aerosol_layer(render PUBLIC core_volume core_scene core_accel core_image core_grid PRIVATE fmt::fmt TBB::tbb)

option(AEROSOL_LEAN "Leave out all effects that core/render/optional_effects.h names, to measure what they cost" OFF)
if(AEROSOL_LEAN)
  target_compile_definitions(core_render PUBLIC AEROSOL_LEAN)
endif()

# LLVM's headers: where core/jit/llvm.h names them, they are parsed once into a precompiled header, which pays from the
# third translation unit on. The compiler cache keeps such objects only when told that time stamps do not matter.
get_target_property(jitType core_jit TYPE)
if(jitType STREQUAL "STATIC_LIBRARY")
  set_target_properties(core_jit PROPERTIES JOB_POOL_COMPILE llvm)
  file(GLOB llvmHeaders CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/jit/llvm.h")
  if(llvmHeaders)
    target_precompile_headers(core_jit PRIVATE ${llvmHeaders})
    if(AEROSOL_CCACHE)
      target_compile_options(core_jit PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
      set_target_properties(core_jit PROPERTIES CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;${AEROSOL_CCACHE}")
    endif()
  endif()
endif()
