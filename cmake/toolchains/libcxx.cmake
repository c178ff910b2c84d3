# Clang 19 with its own C++ library instead of GCC's, linked statically. CYCLOID_LIBCXX is the folder
# of the library (/usr/lib/llvm-19, or where Debian's libc++-19-dev, libc++abi-19-dev and
# libunwind-19-dev were unpacked: they cannot be installed beside those of another version).
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CYCLOID_LIBCXX)
set(CYCLOID_LIBCXX /usr/lib/llvm-19 CACHE PATH "The folder of libc++ 19")
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_FLAGS_INIT "-nostdinc++ -isystem ${CYCLOID_LIBCXX}/include/c++/v1")
set(CMAKE_EXE_LINKER_FLAGS_INIT -nostdlib++)
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT
  "${CYCLOID_LIBCXX}/lib/libc++.a ${CYCLOID_LIBCXX}/lib/libc++abi.a ${CYCLOID_LIBCXX}/lib/libunwind.a")
