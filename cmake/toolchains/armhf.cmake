set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CYCLOID_TRIPLE arm-linux-gnueabihf)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
