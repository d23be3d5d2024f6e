# A hash over the sources that decide what code a shader becomes, as codeVersion() of core/base: what caches keep is
# keyed by it. Run as a script it writes the file; included it says when to.
if(CMAKE_SCRIPT_MODE_FILE)
  file(STRINGS "${LIST}" sources)
  set(all "")
  foreach(source ${sources})
    file(SHA256 "${source}" hash)
    string(APPEND all "${hash}")
  endforeach()
  string(SHA256 version "${all}")
  set(text "#include \"core/base/code_version.h\"\n\nnamespace aerosol {\n\nstd::string_view codeVersion() { return \"${version}\"; }\n\n}  // namespace aerosol\n")
  file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "${text}" @ONLY)
  return()
endif()

file(GLOB_RECURSE codeSources CONFIGURE_DEPENDS
  "${CMAKE_SOURCE_DIR}/core/lang/*.cpp" "${CMAKE_SOURCE_DIR}/core/lang/*.h" "${CMAKE_SOURCE_DIR}/core/jit/*.cpp"
  "${CMAKE_SOURCE_DIR}/core/jit/*.h" "${CMAKE_SOURCE_DIR}/core/shading/*.cpp" "${CMAKE_SOURCE_DIR}/core/shading/*.h")
list(FILTER codeSources EXCLUDE REGEX "/core/jit/runtime/")
list(SORT codeSources)
set(codeList "${CMAKE_BINARY_DIR}/generated/code_sources.txt")
list(JOIN codeSources "\n" codeLines)
file(CONFIGURE OUTPUT "${codeList}" CONTENT "${codeLines}\n" @ONLY)
set(codeVersionSource "${CMAKE_BINARY_DIR}/generated/code_version.cpp")
add_custom_command(
  OUTPUT "${codeVersionSource}"
  COMMAND "${CMAKE_COMMAND}" "-DLIST=${codeList}" "-DOUTPUT=${codeVersionSource}" -P
          "${CMAKE_SOURCE_DIR}/cmake/code_version.cmake"
  DEPENDS ${codeSources} "${codeList}" "${CMAKE_SOURCE_DIR}/cmake/code_version.cmake"
  COMMENT "Hashing the sources of code generation"
  VERBATIM)
target_sources(core_base PRIVATE "${codeVersionSource}")
