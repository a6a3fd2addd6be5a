# The label `hard` on the tests that tests/hard/cases.json names (exact, or with * for any text).
#
# Test cases are discovered when a test program is built, so the label is given when ctest reads its files:
# gtest_discover_tests leaves the names in <program>_TESTS, and the script written here comes after in TEST_INCLUDE_FILES.

set(PELAGE_HARD_CASES ${CMAKE_CURRENT_LIST_DIR}/../../tests/hard/cases.json)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PELAGE_HARD_CASES})

# One regular expression of all names in the manifest.
function(pelage_hard_pattern result)
  file(READ ${PELAGE_HARD_CASES} manifest)
  string(JSON cases LENGTH "${manifest}")
  math(EXPR last_case "${cases} - 1")
  foreach(c RANGE ${last_case})
    string(JSON sub_cases LENGTH "${manifest}" ${c} sub_cases)
    math(EXPR last_sub_case "${sub_cases} - 1")
    foreach(s RANGE ${last_sub_case})
      string(JSON tests LENGTH "${manifest}" ${c} sub_cases ${s} tests)
      math(EXPR last_test "${tests} - 1")
      foreach(t RANGE ${last_test})
        string(JSON name GET "${manifest}" ${c} sub_cases ${s} tests ${t})
        list(APPEND names ${name})
      endforeach()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES names)
  string(REPLACE "." "[.]" names "${names}")
  string(REPLACE "*" ".*" names "${names}")
  string(REPLACE ";" "|" names "${names}")
  set(${result} "^(${names})$" PARENT_SCOPE)
endfunction()

# pelage_label_hard_cases(<program> <labels that its tests have>); after gtest_discover_tests(<program>).
function(pelage_label_hard_cases program labels)
  get_property(pattern GLOBAL PROPERTY PELAGE_HARD_PATTERN)
  if(NOT pattern)
    pelage_hard_pattern(pattern)
    set_property(GLOBAL PROPERTY PELAGE_HARD_PATTERN "${pattern}")
  endif()
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${program}_hard.cmake)
  file(CONFIGURE OUTPUT ${script} @ONLY CONTENT [=[
foreach(test IN LISTS @program@_TESTS)
  string(REGEX REPLACE "  # GetParam.*" "" name "${test}")  # added by the discovery
  if(name MATCHES "@pattern@")
    set_tests_properties("${test}" PROPERTIES LABELS "@labels@;hard")
  endif()
endforeach()
]=])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()
