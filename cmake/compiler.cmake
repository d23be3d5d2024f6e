# Language, warnings, sanitizers, linker, compiler cache: what every translation unit of the program shares.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

set(AEROSOL_SANITIZERS "" CACHE STRING "Sanitizers in the compiler's spelling: address,undefined or thread")

if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang" OR CMAKE_CXX_COMPILER_VERSION VERSION_LESS 19)
  message(FATAL_ERROR "Aerosol needs clang 19 or later (coroutine frames, one toolchain for host and kernels); "
                      "this is ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}. Use a preset: cmake --preset release")
endif()

# The program itself runs on any x86-64-v2 machine; compiled shaders use the processor that they find.
set(AEROSOL_HOST_FLAGS)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND AEROSOL_HOST_FLAGS -march=x86-64-v2)
endif()

# Images must not depend on how a compiler rounds: no contraction and no fast-math.
set(AEROSOL_ARITHMETIC_FLAGS -ffp-contract=off -fno-math-errno)
set(AEROSOL_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Werror
                     -Wno-missing-designated-field-initializers)

add_library(aerosol_flags INTERFACE)
target_compile_options(aerosol_flags INTERFACE ${AEROSOL_HOST_FLAGS} ${AEROSOL_ARITHMETIC_FLAGS} ${AEROSOL_WARNINGS}
                                               -fcoro-aligned-allocation -fmacro-prefix-map=${CMAKE_SOURCE_DIR}/=)
target_include_directories(aerosol_flags INTERFACE "${CMAKE_SOURCE_DIR}")
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(aerosol_flags INTERFACE _GLIBCXX_ASSERTIONS)
endif()

if(AEROSOL_SANITIZERS)
  add_compile_options(-fsanitize=${AEROSOL_SANITIZERS} -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${AEROSOL_SANITIZERS})
  if(AEROSOL_SANITIZERS MATCHES "undefined")
    # It reads the word before what is called, and compiled shaders may begin where a page does.
    add_compile_options(-fno-sanitize=function)
  endif()
endif()

find_program(AEROSOL_MOLD NAMES ld.mold mold)
find_program(AEROSOL_LLD NAMES ld.lld-19 ld.lld)
if(AEROSOL_MOLD)
  add_link_options(-fuse-ld=mold)
elseif(AEROSOL_LLD)
  add_link_options(-fuse-ld=lld)
endif()

# What is not used is not loaded at start-up.
add_link_options(-Wl,--as-needed)

find_program(AEROSOL_CCACHE ccache)
if(AEROSOL_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${AEROSOL_CCACHE}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${AEROSOL_CCACHE}")
endif()

# A translation unit that parses LLVM's headers takes about a gigabyte: as many at a time as memory holds.
cmake_host_system_information(RESULT memoryMegabytes QUERY TOTAL_PHYSICAL_MEMORY)
math(EXPR llvmJobs "${memoryMegabytes} / 4000")
if(llvmJobs LESS 1)
  set(llvmJobs 1)
elseif(llvmJobs GREATER 8)
  set(llvmJobs 8)
endif()
set_property(GLOBAL APPEND PROPERTY JOB_POOLS llvm=${llvmJobs})
