# What `cmake --install` lays down: the libraries to embed, the program, and a package for
# find_package(cycloid). The server is a program, not a library to embed, and stays out.
include(CMakePackageConfigHelpers)

set(CYCLOID_INSTALLED cycloid_solver cycloid_scenes cycloid_protocol cycloid_cli)
set(CYCLOID_HEADER_FOLDERS solver scenes protocol)
if(CYCLOID_NETWORK)
  list(APPEND CYCLOID_INSTALLED cycloid_client cycloid_c)
  list(APPEND CYCLOID_HEADER_FOLDERS client)
endif()

set_target_properties(cycloid_cli PROPERTIES EXPORT_NAME cli)
install(TARGETS ${CYCLOID_INSTALLED} EXPORT cycloidTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# The headers of a folder itself, and of client/replica: deeper folders and what a step works with
# are how it is done inside, and client/net would ask for Asio.
foreach(folder IN LISTS CYCLOID_HEADER_FOLDERS)
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.hpp)
  list(FILTER headers EXCLUDE REGEX "/(step_(context|memory|scratch)|forget_pairs)\\.hpp$")
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cycloid/${folder})
endforeach()
# And what the interface of a world names in deeper folders: queries, characters, constraints of the
# user's own.
foreach(header
    particles/particle.hpp solids/polyhedron.hpp collision/manifold.hpp constraints/rows.hpp
    queries/query.hpp queries/time_of_impact.hpp character/planes.hpp character/mover.hpp)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/solver/${header}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cycloid/solver/${folder})
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/protocol/state ${PROJECT_SOURCE_DIR}/protocol/log
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cycloid/protocol FILES_MATCHING PATTERN "*.hpp")
if(CYCLOID_NETWORK)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/client/replica
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cycloid/client FILES_MATCHING PATTERN "*.hpp")
  install(FILES ${PROJECT_SOURCE_DIR}/client/c/cycloid.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  # The library folder may lie more than one level deep: lib/x86_64-linux-gnu.
  cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX
    BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
    OUTPUT_VARIABLE CYCLOID_PREFIX_FROM_PKGCONFIG)
  configure_file(${PROJECT_SOURCE_DIR}/client/c/cycloid.pc.in
    ${CMAKE_CURRENT_BINARY_DIR}/cycloid.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cycloid.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

set(CYCLOID_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/cycloid)
install(EXPORT cycloidTargets NAMESPACE cycloid:: DESTINATION ${CYCLOID_PACKAGE})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/cycloidConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/cycloidConfig.cmake INSTALL_DESTINATION ${CYCLOID_PACKAGE})
# Below 1.0 every minor version may change the API, and any may change the bits.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/cycloidConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/cycloidConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/cycloidConfigVersion.cmake
  DESTINATION ${CYCLOID_PACKAGE})
