# The catkin package with its messages, or a plain CMake project; where each installs what.
if(FAIL_AWARE_WITH_CATKIN)
  find_package(catkin REQUIRED COMPONENTS
    diagnostic_msgs diagnostic_updater dynamic_reconfigure geometry_msgs message_generation nav_msgs nodelet pluginlib
    rosbag roscpp sensor_msgs std_msgs std_srvs tf2 tf2_msgs tf2_ros visualization_msgs)
  add_message_files(FILES FilterState.msg PoseMeasurement.msg SweepCheck.msg SweepPrediction.msg TimeToFailure.msg)
  generate_messages(DEPENDENCIES geometry_msgs std_msgs)
  generate_dynamic_reconfigure_options(
    cfg/CornerSvd.cfg cfg/FailAwareMonitor.cfg cfg/FusionUkf.cfg cfg/IcpPointToPlane.cfg cfg/IcpPointToPoint.cfg)
  catkin_package(
    INCLUDE_DIRS include
    LIBRARIES ${PROJECT_NAME}_core ${PROJECT_NAME}_bridge
    CATKIN_DEPENDS diagnostic_msgs diagnostic_updater dynamic_reconfigure geometry_msgs message_runtime nav_msgs nodelet
      pluginlib rosbag roscpp sensor_msgs std_msgs std_srvs tf2 tf2_msgs tf2_ros visualization_msgs
    DEPENDS EIGEN3
    CFG_EXTRAS ${PROJECT_NAME}-targets.cmake)
  set(FAIL_AWARE_BIN_DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(FAIL_AWARE_LIB_DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(FAIL_AWARE_INCLUDE_DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})
  set(FAIL_AWARE_SHARE_DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
  set(FAIL_AWARE_PYTHON_DESTINATION ${CATKIN_GLOBAL_PYTHON_DESTINATION})
  if(NOT CATKIN_ENABLE_TESTING)
    set(FAIL_AWARE_BUILD_TESTS OFF)
  endif()
else()
  set(FAIL_AWARE_BIN_DESTINATION lib/${PROJECT_NAME})
  set(FAIL_AWARE_LIB_DESTINATION lib)
  set(FAIL_AWARE_INCLUDE_DESTINATION include/${PROJECT_NAME})
  set(FAIL_AWARE_SHARE_DESTINATION share/${PROJECT_NAME})
  set(FAIL_AWARE_PYTHON_DESTINATION lib/python3/dist-packages)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  enable_testing()
endif()
