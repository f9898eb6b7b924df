# Functions that every CMakeLists.txt of this package uses.

# fail_aware_sources(VARIABLE FOLDER...): all sources below the folders, sorted. A new file need not be listed.
function(fail_aware_sources variable)
  set(patterns ${ARGN})
  list(TRANSFORM patterns APPEND "/*.cpp")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${patterns})
  set(${variable} ${sources} PARENT_SCOPE)
endfunction()

# fail_aware_configure(TARGET [UNITY] [OPTIMIZED] [PRECOMPILE HEADER... | PRECOMPILED_BY TARGET]): options of a library or
# an executable.
#   UNITY       compiles the sources in groups of eight, so that Eigen's and ROS's templates are instantiated once a group.
#               Names in anonymous namespaces must then differ within a group. Tests need not care: each has a
#               namespace with its file's name.
#   PRECOMPILE  these headers, and those that most sources include
#   PRECOMPILED_BY  takes what the other executable, which is then built before, has precompiled
#   OPTIMIZED   an executable that computes much in its own sources
# Libraries are optimized as the build type says. Executables (tools, tests) leave the work to the libraries: with -O1 they
# compile in four fifths of the time and run as fast. That is also why a library must call its own functions, not an
# executable's copies of inline ones (-Bsymbolic-functions).
function(fail_aware_configure target)
  cmake_parse_arguments(with "UNITY;OPTIMIZED" "PRECOMPILED_BY" "PRECOMPILE" ${ARGN})
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL EXECUTABLE)
    if(NOT with_OPTIMIZED)
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
  elseif(type STREQUAL SHARED_LIBRARY)
    target_link_options(${target} PRIVATE "LINKER:-Bsymbolic-functions")
  endif()
  set_target_properties(${target} PROPERTIES
    POSITION_INDEPENDENT_CODE ON
    # From lib/PACKAGE/ to lib/: installed tools run without a sourced workspace too.
    INSTALL_RPATH "$ORIGIN;$ORIGIN/.."
    INSTALL_RPATH_USE_LINK_PATH ON)
  if(FAIL_AWARE_FAST_BUILD AND with_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
  if(FAIL_AWARE_FAST_BUILD AND with_PRECOMPILE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)  # ccache keeps no such units
    target_precompile_headers(${target} PRIVATE
      <Eigen/Dense> <algorithm> <cmath> <functional> <optional> <string> <vector> ${with_PRECOMPILE})
  endif()
  if(with_PRECOMPILED_BY)
    get_target_property(precompiled ${with_PRECOMPILED_BY} PRECOMPILE_HEADERS)
    if(precompiled)
      target_precompile_headers(${target} REUSE_FROM ${with_PRECOMPILED_BY})
    endif()
  endif()
endfunction()

# fail_aware_install(LIBRARY [EXPORT NAME])
function(fail_aware_install target)
  install(TARGETS ${target} ${ARGN}
    ARCHIVE DESTINATION ${FAIL_AWARE_LIB_DESTINATION}
    LIBRARY DESTINATION ${FAIL_AWARE_LIB_DESTINATION}
    RUNTIME DESTINATION bin)
endfunction()
