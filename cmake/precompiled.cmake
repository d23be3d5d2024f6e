# Builds that are made for their tests alone (presets sanitize, debug-O0, tsan) parse the headers that most files share
# once for each library: 0.7 s less a translation unit, of 2 to 5 s. Include lists are held by the release build.

option(AEROSOL_PRECOMPILED "Precompile the headers that most files include" OFF)
if(AEROSOL_PRECOMPILED)
  # Times of files are left out of what is compared, so that the compiler cache keeps these objects as well.
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
  if(AEROSOL_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;${AEROSOL_CCACHE}")
  endif()
endif()

# aerosol_precompile(<target> [<header>...]): a precompiled header pays from some sources on.
function(aerosol_precompile target)
  get_target_property(sources ${target} SOURCES)
  list(LENGTH sources count)
  if(AEROSOL_PRECOMPILED AND count GREATER 5)
    target_precompile_headers(${target} PRIVATE "${CMAKE_SOURCE_DIR}/cmake/precompiled.h" ${ARGN})
  endif()
endfunction()
