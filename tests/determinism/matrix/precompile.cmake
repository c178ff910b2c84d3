# Parses the libraries that nearly every file of the solver and the scenes includes once a row, which
# saves a third of its time. Given to CMake by build.py, so that no other build depends on it: there,
# a file that forgets an include does not compile.
function(precompile_for_the_matrix)
  foreach(target IN ITEMS cycloid_solver cycloid_scenes)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <algorithm> <functional> <map> <memory>
      <optional> <span> <string> <variant> <vector>)
    # GCC takes its own library for ours once it is precompiled, and warns of it. Every other build
    # has the warnings.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-w>)
  endforeach()
  # Compiled with flags of their own, which do not fit what was parsed without them.
  set(solver ${CMAKE_SOURCE_DIR}/solver)
  set_source_files_properties(
    ${solver}/collision/four_cornered_avx2.cpp
    ${solver}/constraints/contact_kernels.cpp ${solver}/constraints/contact_kernels_avx2.cpp
    ${solver}/instruction_sets.cpp
    TARGET_DIRECTORY cycloid_solver PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL precompile_for_the_matrix)
