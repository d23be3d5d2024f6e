# tests/bench: Google Benchmark, not a test. Files named *_native.cpp are the yardstick, plain C++ as fast as the compiler
# makes it for this machine; *_native_<lanes>.cpp prefer vectors of that many floats.

# Sources named as above take that machine's best code.
function(aerosol_yardsticks)
  foreach(source ${ARGN})
    if(source MATCHES "_native(_([0-9]+))?\\.cpp$")
      # A hypervisor may hide half of a feature pair, which clang mends with a warning.
      set(options -O3 -march=native -Wno-invalid-feature-combination)
      if(CMAKE_MATCH_2)
        math(EXPR bits "${CMAKE_MATCH_2} * 32")
        list(APPEND options -mprefer-vector-width=${bits})
      endif()
      set_source_files_properties("${source}" PROPERTIES COMPILE_OPTIONS "${options}")
    endif()
  endforeach()
endfunction()

find_package(benchmark CONFIG QUIET)
file(GLOB benchmarkSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/bench/*.cpp")
if(benchmarkSources AND benchmark_FOUND)
  add_executable(benchmarks ${benchmarkSources})
  target_link_libraries(benchmarks PRIVATE core_app aerosol_flags aerosol_openvdb benchmark::benchmark benchmark::benchmark_main fmt::fmt)
  target_compile_definitions(benchmarks PRIVATE AEROSOL_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  add_dependencies(benchmarks aerosol_support)
  aerosol_yardsticks(${benchmarkSources})
endif()

# tests/bench/tables: programs that print comparisons; not built by default.
file(GLOB tableSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/bench/tables/*.cpp")
foreach(source ${tableSources})
  get_filename_component(name "${source}" NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL "${source}")
  target_link_libraries(${name} PRIVATE test_support aerosol_embree fmt::fmt ${CMAKE_DL_LIBS})
  add_dependencies(${name} aerosol_support)
endforeach()

# tests/bench/shader_table: compiled shaders beside hand-written C++; not built by default.
file(GLOB shaderTableSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/bench/shader_table/*.cpp")
add_executable(shader_table EXCLUDE_FROM_ALL ${shaderTableSources})
target_link_libraries(shader_table PRIVATE test_support aerosol_flags fmt::fmt)
add_dependencies(shader_table aerosol_support)
aerosol_yardsticks(${shaderTableSources})

# tests/bench/places: where volumes are, and what overlap costs, as printed tables; not built by default.
file(GLOB placesSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/bench/places/*.cpp")
add_executable(places EXCLUDE_FROM_ALL ${placesSources})
target_link_libraries(places PRIVATE test_support aerosol_openvdb fmt::fmt)
add_dependencies(places aerosol_support)

# tests/bench/equal_time: all methods of sampling against each other. A test runs the smallest size of it.
file(GLOB equalTimeSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/bench/equal_time/*.cpp")
add_executable(equal_time ${equalTimeSources})
target_link_libraries(equal_time PRIVATE test_support fmt::fmt)
add_dependencies(equal_time aerosol_support)
find_program(AEROSOL_BASH bash REQUIRED)
add_test(NAME bench.equal_time COMMAND "${AEROSOL_BASH}" "${CMAKE_SOURCE_DIR}/tests/bench/equal_time/smoke_test.sh"
                                       $<TARGET_FILE:equal_time>)
set_tests_properties(bench.equal_time PROPERTIES LABELS bench TIMEOUT 600)
