# Installs the boxes, their headers and the package files that find_package(Pelage) reads.
# An engine links pelage::runtime (or single boxes) and needs of the programs' libraries only what these link.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Pelage)

get_property(boxes GLOBAL PROPERTY PELAGE_BOXES)
list(REMOVE_ITEM boxes pelage_console)  # the programs' own

add_library(pelage_runtime INTERFACE)
add_library(pelage::runtime ALIAS pelage_runtime)
target_link_libraries(pelage_runtime INTERFACE pelage_hair pelage_shading pelage_satf pelage_shadow
                      pelage_simulate)
set_target_properties(pelage_runtime PROPERTIES EXPORT_NAME runtime)

install(TARGETS ${boxes} pelage_runtime EXPORT PelageTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(target IN LISTS boxes)
  string(REPLACE "pelage_" "" box ${target})
  get_target_property(folder ${target} SOURCE_DIR)
  file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.h)  # headers only: which of them are public is said below
  list(FILTER headers EXCLUDE REGEX "/(json_[a-z]*|[a-z_]*_fields|validate)\\.h$")  # need nlohmann-json
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pelage/${box})
endforeach()
install(DIRECTORY data_schema/schemas data_schema/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/pelage)
install(FILES data_schema/SCHEMA.md data_schema/hrir.sql
        DESTINATION ${CMAKE_INSTALL_DATADIR}/pelage)
install(EXPORT PelageTargets NAMESPACE pelage:: DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/PelageConfig.cmake.in ${PROJECT_BINARY_DIR}/PelageConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/PelageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/PelageConfig.cmake ${PROJECT_BINARY_DIR}/PelageConfigVersion.cmake
        DESTINATION ${package_folder})
