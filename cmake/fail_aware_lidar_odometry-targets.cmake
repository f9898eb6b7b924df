# fail_aware_lidar_odometry::core, the odometry without ROS, for who calls find_package(fail_aware_lidar_odometry).
if(NOT TARGET fail_aware_lidar_odometry::core)
  include(CMakeFindDependencyMacro)
  find_dependency(Eigen3 3.3 NO_MODULE)
  find_dependency(Threads)
  find_package(TBB QUIET)       # named by the targets of a static build only
  find_package(yaml-cpp QUIET)
  include(${fail_aware_lidar_odometry_DIR}/fail_aware_lidar_odometryTargets.cmake)
endif()
