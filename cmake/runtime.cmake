# The kernels' runtime library: C++ templates over the number type, as bitcode for each domain and width. This is code of
# the shaders, not of the program, so none of the program's flags apply.

find_program(AEROSOL_BITCODE_COMPILER NAMES clang++-19 REQUIRED)
set(AEROSOL_WIDTHS 1 4 8 16)
set(AEROSOL_DOMAINS wide range)
set(runtimeFlags
    -std=c++20 -O2 -emit-llvm -c -ffreestanding -fno-exceptions -fno-rtti -ffp-contract=off -fno-math-errno
    -fno-vectorize -fno-slp-vectorize -fno-unroll-loops -fno-stack-protector -fno-asynchronous-unwind-tables
    -fvisibility=hidden -fPIC -Wall -Wextra -Wshadow -Werror -Wno-psabi)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND runtimeFlags -march=x86-64-v3)
endif()

set(runtimeSource "${CMAKE_SOURCE_DIR}/core/jit/runtime/runtime.cpp")
set(runtimeFolder "${CMAKE_BINARY_DIR}/lib/aerosol/runtime")
set(runtimeFiles)
file(GLOB runtimeSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/jit/runtime/*.cpp")
if(EXISTS "${runtimeSource}")
  foreach(domain ${AEROSOL_DOMAINS})
    string(TOUPPER ${domain} domainUpper)
    foreach(width ${AEROSOL_WIDTHS})
      set(output "${runtimeFolder}/runtime_${domain}_${width}.bc")
      set(depfile "${CMAKE_BINARY_DIR}/runtime_${domain}_${width}.d")
      add_custom_command(
        OUTPUT "${output}"
        COMMAND "${CMAKE_COMMAND}" -E make_directory "${runtimeFolder}"
        COMMAND ${AEROSOL_CCACHE} "${AEROSOL_BITCODE_COMPILER}" ${runtimeFlags} -DAEROSOL_WIDTH=${width}
                -DAEROSOL_DOMAIN_${domainUpper}=1 -I "${CMAKE_SOURCE_DIR}" -MD -MF "${depfile}" -MT "${output}" -o
                "${output}" "${runtimeSource}"
        DEPENDS "${runtimeSource}"
        DEPFILE "${depfile}"
        COMMENT "Compiling the kernels' runtime library: ${domain}, ${width} lanes"
        VERBATIM)
      list(APPEND runtimeFiles "${output}")
    endforeach()
  endforeach()
endif()
add_custom_target(runtime_bitcode ALL DEPENDS ${runtimeFiles})
