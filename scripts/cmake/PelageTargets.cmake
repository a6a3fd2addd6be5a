# One CMake target per box of the architecture. Each box sees only the headers of the boxes it links:
# its include root holds a single link `pelage/<box>` to its own folder, so a wrong arrow fails to build.

add_library(pelage_options INTERFACE)
target_compile_features(pelage_options INTERFACE cxx_std_20)
target_compile_options(pelage_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -ffp-contract=off
  # GCC 12 reports impossible overlaps inside std::string (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(PELAGE_SANITIZE)
  target_compile_options(pelage_options INTERFACE -fsanitize=${PELAGE_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # GCC's manual: sanitizers raise false ones (here inside std::regex, GCC bug 105562). Other builds keep it.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(pelage_options INTERFACE -fsanitize=${PELAGE_SANITIZE})
endif()
if(PELAGE_SANITIZE MATCHES thread)
  # A stand-in for oneTBB that the sanitizer sees through (tests/sanitizers/tbb/threads.h).
  target_include_directories(pelage_options BEFORE INTERFACE ${PROJECT_SOURCE_DIR}/tests/sanitizers)
  # Functions in versions for several CPUs are chosen by code that the loader calls before the sanitizer has begun: it crashes.
  target_compile_options(pelage_options INTERFACE "-Dtarget_clones(...)=")
endif()
if(PELAGE_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
    message(FATAL_ERROR "libFuzzer comes with clang: configure with --preset fuzz")
  endif()
  target_compile_options(pelage_options INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(pelage_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# For code that a program runs once, not in loops (options, scenes, pages, orchestration): compiles in two thirds of the time,
# and values stay the same, since no optimisation here may change them.
set(PELAGE_COLD $<$<CONFIG:Release>:-O1>)
function(pelage_cold target)
  target_compile_options(${target} PRIVATE ${PELAGE_COLD})
endfunction()

# pelage_box(<box> SOURCES ... [PUBLIC targets...] [PRIVATE targets...])
# Defines the static library pelage_<box> with the alias pelage::<box>; headers are included as "pelage/<box>/name.h".
function(pelage_box box)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;PUBLIC;PRIVATE")
  set(root ${PROJECT_BINARY_DIR}/include/${box})
  file(MAKE_DIRECTORY ${root}/pelage)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/pelage/${box} SYMBOLIC)
  add_library(pelage_${box} STATIC ${arg_SOURCES})
  add_library(pelage::${box} ALIAS pelage_${box})
  target_include_directories(pelage_${box} PUBLIC
    $<BUILD_INTERFACE:${root}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(pelage_${box} PUBLIC cxx_std_20)
  target_link_libraries(pelage_${box} PUBLIC ${arg_PUBLIC}
                        PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:pelage_options>)
  set_target_properties(pelage_${box} PROPERTIES EXPORT_NAME ${box} POSITION_INDEPENDENT_CODE ON)
  set_property(GLOBAL APPEND PROPERTY PELAGE_BOXES pelage_${box})
endfunction()

# pelage_test(<name> SOURCES ... LINK ... [LABELS ...]): one GoogleTest program, one ctest entry per test case.
function(pelage_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK;LABELS")
  if(NOT arg_LABELS)
    set(arg_LABELS fast)
  endif()
  add_executable(test_${name} ${arg_SOURCES})
  target_link_libraries(test_${name} PRIVATE ${arg_LINK} pelage_options GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE
    PELAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" PELAGE_BINARY_DIR="${PROJECT_BINARY_DIR}")
  # Compiles a test a third faster; what it tests stays at -O3.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "${arg_LABELS}" TIMEOUT 600)
  pelage_label_hard_cases(test_${name} "${arg_LABELS}")
endfunction()

# pelage_embed(<target> NAMESPACE ns OUTPUT stem FILES ...): the text of each file as a std::string_view constant
# `ns::<file_name_with_underscores>` in the generated header <stem>.h and source <stem>.cpp.
function(pelage_embed target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "NAMESPACE;OUTPUT" "FILES")
  set(header ${CMAKE_CURRENT_BINARY_DIR}/generated/${arg_OUTPUT}.h)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/generated/${arg_OUTPUT}.cpp)
  list(TRANSFORM arg_FILES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE inputs)
  add_custom_command(OUTPUT ${header} ${source}
    COMMAND ${CMAKE_COMMAND} "-DFILES=${inputs}" -DNAMESPACE=${arg_NAMESPACE} -DHEADER=${header} -DSOURCE=${source}
            -P ${PROJECT_SOURCE_DIR}/scripts/cmake/embed.cmake
    DEPENDS ${inputs} ${PROJECT_SOURCE_DIR}/scripts/cmake/embed.cmake VERBATIM)
  target_sources(${target} PRIVATE ${source} ${header})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated)
endfunction()
