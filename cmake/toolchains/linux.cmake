# Included by the toolchain files of this folder, with CYCLOID_TRIPLE set. Statically linked, so that
# the program runs under qemu-user without the libraries of the target.
set(CMAKE_SYSTEM_NAME Linux)
if(NOT CMAKE_CXX_COMPILER)
  set(CMAKE_CXX_COMPILER ${CYCLOID_TRIPLE}-g++)
endif()
set(CMAKE_CXX_COMPILER_TARGET ${CYCLOID_TRIPLE})  # Read by Clang; GCC is of one target anyway.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
