# Compiles a row's program in a tenth of the time: what nearly every file of the solver and the
# scenes includes is parsed once, and files are compiled sixteen at a time. Given to CMake by
# build.py, and by cmake/united.cmake for `./dev sanitize --quick`, so that the build of `./dev test`
# does not depend on it: there, a file that forgets an include does not compile, and each file is a
# unit, held to the same goldens.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)

# Files with names of their own for what another file of the folder means something else by; and
# those that the gate on objects knows by name.
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
  # Compiled with flags of their own, which do not fit what was parsed without them.
  set(with_flags_of_their_own solver/bodies/body_kernels_avx2.cpp
    solver/bodies/body_kernels_avx512.cpp solver/collision/bounds_kernels_avx2.cpp
    solver/collision/bounds_kernels_avx512.cpp solver/collision/few_cornered_avx2.cpp
    solver/collision/few_cornered_avx512.cpp solver/collision/solid_kernels_avx2.cpp
    solver/collision/solid_kernels_avx512.cpp solver/constraints/contact_kernels.cpp
    solver/constraints/contact_kernels_avx2.cpp solver/constraints/contact_kernels_avx512.cpp
    solver/constraints/pin_kernels.cpp solver/constraints/pin_kernels_avx2.cpp
    solver/constraints/pin_kernels_avx512.cpp
    solver/tracing/digest_kernels_avx2.cpp solver/tracing/digest_kernels_avx512.cpp
    solver/instruction_sets.cpp)
  compile_alone(cycloid_solver ${with_flags_of_their_own})
  list(TRANSFORM with_flags_of_their_own PREPEND ${CMAKE_SOURCE_DIR}/)
  set_source_files_properties(${with_flags_of_their_own} TARGET_DIRECTORY cycloid_solver
    PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  # Clang takes no instantiation of a class behind those of its members in other files.
  compile_alone(cycloid_solver solver/world.cpp)
  compile_alone(cycloid_protocol protocol/state/layout.cpp protocol/state/quantised_delta.cpp
    protocol/wire/server_codec.cpp)
  compile_alone(cycloid_scenes scenes/json_reader.cpp scenes/json_writer.cpp
    scenes/characters.cpp scenes/generators/characters_3d.cpp scenes/generators/ragdolls_3d.cpp)
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL precompile_for_the_matrix)
