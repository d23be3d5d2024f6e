# Third-party libraries, one interface target each. Only the layer that wraps a library links its target, and headers
# come in as system headers.

find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(fmt REQUIRED)
find_package(pugixml REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
# Debian's Imath package configuration names files of its Python package; pkg-config does not.
pkg_check_modules(Imath REQUIRED IMPORTED_TARGET Imath)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)

# Debian's OpenImageIO package configuration demands OpenCV's headers; pkg-config does not.
pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
pkg_check_modules(OpenColorIO REQUIRED IMPORTED_TARGET OpenColorIO)

# OpenVDB with NanoVDB's headers. Debian has no package configuration for them; the headers convert ints to enums that
# do not have such values.
find_library(AEROSOL_OPENVDB_LIBRARY openvdb REQUIRED)
add_library(aerosol_openvdb INTERFACE)
if(AEROSOL_SANITIZERS MATCHES "undefined")
  # TBB's hash map marks its buckets with odd addresses.
  target_compile_options(aerosol_openvdb INTERFACE -fno-sanitize=alignment)
endif()
target_link_libraries(aerosol_openvdb INTERFACE "${AEROSOL_OPENVDB_LIBRARY}" TBB::tbb PkgConfig::Imath)
target_compile_options(aerosol_openvdb INTERFACE -Wno-enum-constexpr-conversion)

# Embree 3 or 4, whichever is there; code tells them by RTC_VERSION_MAJOR and by AEROSOL_EMBREE_VERSION.
add_library(aerosol_embree INTERFACE)
find_package(embree 4 CONFIG QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 CONFIG REQUIRED)
endif()
string(REGEX MATCH "^[0-9]+" embreeMajor "${embree_VERSION}")
target_link_libraries(aerosol_embree INTERFACE embree)
target_compile_definitions(aerosol_embree INTERFACE AEROSOL_EMBREE_VERSION=${embreeMajor})

# LLVM and clang as shared libraries only: a second copy in one process aborts.
find_program(AEROSOL_LLVM_CONFIG NAMES llvm-config-19 REQUIRED)
foreach(what version includedir libdir)
  execute_process(COMMAND "${AEROSOL_LLVM_CONFIG}" --${what} OUTPUT_VARIABLE llvm_${what}
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endforeach()
find_library(AEROSOL_LLVM_LIBRARY NAMES LLVM-19 LLVM HINTS "${llvm_libdir}" NO_DEFAULT_PATH REQUIRED)
find_library(AEROSOL_CLANG_LIBRARY NAMES clang-cpp19 clang-cpp HINTS "${llvm_libdir}" NO_DEFAULT_PATH REQUIRED)
# Debian's own LLVM is on the system's library path; another has to be named.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
if(NOT llvm_libdir STREQUAL "/usr/lib/llvm-19/lib")
  set(CMAKE_INSTALL_RPATH "${llvm_libdir}")
endif()
add_library(aerosol_llvm INTERFACE)
target_include_directories(aerosol_llvm SYSTEM INTERFACE "${llvm_includedir}")
target_compile_definitions(aerosol_llvm INTERFACE __STDC_CONSTANT_MACROS __STDC_FORMAT_MACROS __STDC_LIMIT_MACROS)
target_link_libraries(aerosol_llvm INTERFACE "${AEROSOL_LLVM_LIBRARY}")
add_library(aerosol_clang INTERFACE)
target_link_libraries(aerosol_clang INTERFACE "${AEROSOL_CLANG_LIBRARY}" aerosol_llvm)

# Header-only command line parser.
find_package(CLI11 CONFIG REQUIRED)
