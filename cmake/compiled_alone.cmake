# Files that are never compiled together with others, by the matrix or by `./dev sanitize --quick`.

# Compiled with flags of their own, which do not fit what was parsed without them: the kernels of an
# instruction set, by their names, and these.
file(GLOB KERNELS_OF_A_SET CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}
  ${CMAKE_SOURCE_DIR}/solver/*/*_avx2.cpp ${CMAKE_SOURCE_DIR}/solver/*/*_avx512.cpp)
set(WITH_FLAGS_OF_THEIR_OWN ${KERNELS_OF_A_SET} solver/constraints/contact_kernels.cpp
  solver/constraints/pin_kernels.cpp solver/instruction_sets.cpp)

# Where callers see the text of a kernel they make copies of those for AVX2 and AVX-512 without either,
# and of two copies the linker keeps the first: none of the kernels themselves would be run.
file(GLOB PORTABLE_KERNELS CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}
  ${CMAKE_SOURCE_DIR}/solver/*/*_kernels.cpp)

# Clang takes no instantiation of a class behind those of its members in other files; the others have
# names of their own for what another file of the folder means something else by, or are known by
# name to the gate on objects.
set(COMPILED_ALONE ${WITH_FLAGS_OF_THEIR_OWN} ${PORTABLE_KERNELS} solver/collision/few_cornered.cpp
  solver/world.cpp
  protocol/state/layout.cpp protocol/state/quantised_delta.cpp protocol/wire/server_codec.cpp
  scenes/json_reader.cpp scenes/json_writer.cpp scenes/characters.cpp
  scenes/generators/characters_3d.cpp scenes/generators/ragdolls_3d.cpp)
