# cmake -DSOURCE=... -P: configures SOURCE into WORK for library folders of unequal depths, and reads
# from cycloid.pc where pkg-config would look for the prefix.
function(expect_way_up libdir)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G ${GENERATOR}
    -DCMAKE_INSTALL_PREFIX=/opt/cycloid -DCMAKE_INSTALL_LIBDIR=${libdir} -DCYCLOID_TESTS=OFF
    -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DEigen3_DIR=${EIGEN}
    COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
  file(STRINGS ${WORK}/cycloid.pc line REGEX "^prefix=")
  string(REPLACE "prefix=\${pcfiledir}" "/opt/cycloid/${libdir}/pkgconfig" found "${line}")
  cmake_path(NORMAL_PATH found)
  string(REGEX REPLACE "/$" "" found "${found}")
  if(NOT found STREQUAL "/opt/cycloid")
    message(FATAL_ERROR "library folder ${libdir}: \"${line}\" leads to \"${found}\"")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
expect_way_up(lib)
expect_way_up(lib/x86_64-linux-gnu)
