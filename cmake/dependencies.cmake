# Libraries without ROS. Debian and Ubuntu differ in which of them come with a CMake configuration.
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
find_package(yaml-cpp REQUIRED)
if(TARGET yaml-cpp::yaml-cpp)  # since 0.8
  set(YAML_CPP_TARGET yaml-cpp::yaml-cpp)
else()
  set(YAML_CPP_TARGET yaml-cpp)
endif()

# fail_aware_import(TARGET LIBRARY HEADER PACKAGE): TARGET is a library without a CMake configuration.
function(fail_aware_import target library header package)
  string(MAKE_C_IDENTIFIER ${library} name)
  string(TOUPPER ${name} name)
  find_library(${name}_LIBRARY ${library})
  find_path(${name}_INCLUDE_DIR ${header})
  if(NOT ${name}_LIBRARY OR NOT ${name}_INCLUDE_DIR)
    message(FATAL_ERROR "${library} not found (Debian, Ubuntu: ${package})")
  endif()
  add_library(${target} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES
    IMPORTED_LOCATION ${${name}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${${name}_INCLUDE_DIR})
endfunction()

find_package(TBB QUIET CONFIG)
if(NOT TARGET TBB::tbb)  # Ubuntu 20.04
  fail_aware_import(TBB::tbb tbb tbb/task_arena.h libtbb-dev)
endif()

find_path(ROBIN_MAP_INCLUDE_DIR tsl/robin_map.h)
if(NOT ROBIN_MAP_INCLUDE_DIR)
  message(FATAL_ERROR "tsl/robin_map.h not found (Debian, Ubuntu: robin-map-dev)")
endif()

# Tools and evaluation
set(FAIL_AWARE_WITH_TOOLS ON)
find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp)
if(CLI11_INCLUDE_DIR)
  find_package(nlohmann_json 3 REQUIRED)
  fail_aware_import(nlopt::nlopt nlopt nlopt.h libnlopt-dev)
else()
  set(FAIL_AWARE_WITH_TOOLS OFF)
  message(WARNING "CLI/CLI.hpp not found: all but the tools is built, and what tests these is left out (Debian 12: "
                  "libcli11-dev; Debian 11 and Ubuntu 20.04 have no package: get CLI11's single header and give "
                  "-DCLI11_INCLUDE_DIR=FOLDER, scripts/build --cli11 FOLDER, where FOLDER/CLI/CLI.hpp is)")
endif()

if(FAIL_AWARE_WITH_SIMULATION)
  fail_aware_import(embree::embree embree3 embree3/rtcore.h
    "libembree-dev; without the simulator: -DFAIL_AWARE_WITH_SIMULATION=OFF")
endif()
