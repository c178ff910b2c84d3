# Compiles a row's program in a tenth of the time: what nearly every file of the solver and the
# scenes includes is parsed once, and files are compiled sixteen at a time. Given to CMake by
# build.py, and by cmake/united.cmake for `./dev sanitize --quick`, so that the build of `./dev test`
# does not depend on it: there, each file of the solver, the scenes and the protocol is a unit, held
# to the same goldens, and one that forgets an include does not compile.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)

include(${CMAKE_CURRENT_LIST_DIR}/../../../cmake/compiled_alone.cmake)

function(compile_alone target)
  list(TRANSFORM ARGN PREPEND ${CMAKE_SOURCE_DIR}/)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target}
    PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(precompile_for_the_matrix)
  foreach(target IN ITEMS cycloid_solver cycloid_scenes)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <algorithm> <functional> <map> <memory>
      <optional> <span> <string> <variant> <vector>)
    # GCC takes its own library for ours once it is precompiled, and warns of it. Every other build
    # has the warnings.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-w>)
  endforeach()
  foreach(folder IN ITEMS solver scenes protocol)
    set(alone ${COMPILED_ALONE})
    list(FILTER alone INCLUDE REGEX "^${folder}/")
    compile_alone(cycloid_${folder} ${alone})
  endforeach()
  list(TRANSFORM WITH_FLAGS_OF_THEIR_OWN PREPEND ${CMAKE_SOURCE_DIR}/)
  set_source_files_properties(${WITH_FLAGS_OF_THEIR_OWN} TARGET_DIRECTORY cycloid_solver
    PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  # All in one: `one_unit` in tests/ cannot know which commands a row leaves out.
  set_target_properties(cycloid_cli PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL precompile_for_the_matrix)
