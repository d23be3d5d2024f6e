# The tests that the table of hard cases names stand in several folders. Builds with AddressSanitizer gather their sources
# in hard_case_tests, which runs these tests of theirs and all of its own.

if(NOT TARGET hard_case_tests OR NOT AEROSOL_SANITIZERS MATCHES "address")
  return()
endif()

set(table "${CMAKE_SOURCE_DIR}/tests/hard_cases/cases.md")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${table}")
file(READ "${table}" text)
string(REGEX MATCHALL "[A-Za-z]+\\.[A-Za-z]+" named "${text}")

file(GLOB ownSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/hard_cases/*.cpp")
file(GLOB otherSources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/tests/render/*.cpp"
                                         "${CMAKE_SOURCE_DIR}/tests/statistical/*.cpp")
set(filter "")
foreach(source ${ownSources} ${otherSources})
  file(READ "${source}" text)
  string(REGEX MATCHALL "TEST[_A-Z]*\\([A-Za-z]+,[ \n]*[A-Za-z]+" definitions "${text}")
  set(isNamed FALSE)
  foreach(definition ${definitions})
    string(REGEX REPLACE "^.*\\(([A-Za-z]+),[ \n]*([A-Za-z]+)$" "\\1.\\2" test "${definition}")
    if(source IN_LIST ownSources OR test IN_LIST named)
      string(APPEND filter "${test}:*/${test}/*:")
      set(isNamed TRUE)
    endif()
  endforeach()
  if(isNamed AND NOT source IN_LIST ownSources)
    target_sources(hard_case_tests PRIVATE "${source}")
  endif()
endforeach()
target_link_libraries(hard_case_tests PRIVATE core_app ZLIB::ZLIB)
set_property(TEST hard_case_tests APPEND PROPERTY ENVIRONMENT "GTEST_FILTER=${filter}")
