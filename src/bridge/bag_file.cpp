#include "fail_aware_lidar_odometry/bridge/bag_file.hpp"

#include "core/io/input_error.hpp"

namespace fail_aware {

BagFile::BagFile(const std::string& path) : path_(path) {
  try {
    bag_ = std::make_unique<rosbag::Bag>(path, rosbag::bagmode::Write);
  } catch (const rosbag::BagException& error) {
    throw InputError("cannot write " + path + ": " + error.what());
  }
}

BagFile::~BagFile() {
  try {
    close();
  } catch (const std::exception&) {
  }
}

void BagFile::close() {
  if (!bag_) return;
  try {
    bag_->close();
    bag_.reset();
  } catch (const rosbag::BagException& error) {
    fail("cannot complete ", error.what());
  }
}

void BagFile::fail(const std::string& what, const std::string& reason) {
  static_cast<void>(bag_.release());
  throw std::runtime_error(what + path_ + ": " + reason);
}

}  // namespace fail_aware
