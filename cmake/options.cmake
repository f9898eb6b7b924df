# What a user may choose, and what every source is compiled with.
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)  # for scripts/lint
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

if(NOT DEFINED FAIL_AWARE_WITH_CATKIN)
  find_package(catkin QUIET)
endif()
option(FAIL_AWARE_WITH_CATKIN "Build as a catkin package" ${catkin_FOUND})
option(BUILD_SHARED_LIBS "Build shared libraries" ON)
option(FAIL_AWARE_BUILD_TESTS "Build the tests" ON)
option(FAIL_AWARE_WITH_SIMULATION "Build the drive simulator (needs Embree 3)" ON)
option(FAIL_AWARE_FAST_BUILD
  "Unity builds and precompiled headers: a whole build is shorter, one after a small change is longer" ON)
option(FAIL_AWARE_FUZZ "Build the fuzz targets (needs clang++)" OFF)
set(FAIL_AWARE_SANITIZE "" CACHE STRING "Build with sanitizers: address, undefined or thread")

if(FAIL_AWARE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
if(FAIL_AWARE_SANITIZE)
  add_compile_options(-fsanitize=${FAIL_AWARE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1 -O1)
  add_link_options(-fsanitize=${FAIL_AWARE_SANITIZE})
endif()
