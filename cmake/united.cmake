# Compiles the solver, the scenes and the protocol many files at a time, as the matrix does, and all
# else as every build does: for `./dev sanitize --quick`, which CI waits for. Given to CMake by its
# preset.
include(${CMAKE_SOURCE_DIR}/tests/determinism/matrix/precompile.cmake)
set(CMAKE_UNITY_BUILD OFF)

function(unite_the_solver)
  set_target_properties(cycloid_solver cycloid_scenes cycloid_protocol PROPERTIES
    UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL unite_the_solver)
