// Writes a bag: rosbag::Bag with this package's errors.
//
// Failure: the constructor throws InputError if the file cannot be opened; write() and close() throw std::runtime_error
// if it cannot be written, and after that the object writes nothing more. Memory: the bag's index.
#pragma once

#include <ros/message_traits.h>
#include <rosbag/bag.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <stdexcept>
#include <string>

namespace fail_aware {

class BagFile {
 public:
  explicit BagFile(const std::string& path);
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;
  ~BagFile();

  template <class Message>
  void write(const std::string& topic, const ros::Time& stamp, const Message& message,
             const boost::shared_ptr<ros::M_string>& connection_header = nullptr) {
    if (!bag_) throw std::runtime_error(path_ + ": is closed");
    try {
      bag_->write(topic, stamp, message, connection_header);
    } catch (const rosbag::BagException& error) {
      fail("cannot write ", error.what());
    }
  }

  /// Writes like a publisher that latches (`/tf_static`).
  template <class Message>
  void writeLatched(const std::string& topic, const ros::Time& stamp, const Message& message,
                    const std::string& caller) {
    const auto header = boost::make_shared<ros::M_string>();
    (*header)["callerid"] = caller;
    (*header)["latching"] = "1";
    (*header)["md5sum"] = ros::message_traits::md5sum(message);
    (*header)["message_definition"] = ros::message_traits::definition(message);
    (*header)["type"] = ros::message_traits::datatype(message);
    write(topic, stamp, message, header);
  }

  void close();

 private:
  /// Throws, and leaks the bag: the destructor of a bag that cannot be closed would end the program.
  [[noreturn]] void fail(const std::string& what, const std::string& reason);

  std::string path_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace fail_aware
