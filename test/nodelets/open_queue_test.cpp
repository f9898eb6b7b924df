#include "../../src/nodelets/open_queue.hpp"

#include <gtest/gtest.h>
#include <nodelet/detail/callback_queue_manager.h>
#include <ros/callback_queue.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <future>

namespace fail_aware::open_queue_test {
namespace {

struct Call : ros::CallbackInterface {
  CallResult call() override {
    called.set_value();
    return Success;
  }
  std::promise<void> called;
};

TEST(OpenQueue, WhatComesWhileANodeletIsLoadedIsNotLost) {
  nodelet::detail::CallbackQueueManager manager(1);
  const auto queue = boost::make_shared<nodelet::detail::CallbackQueue>(&manager);
  manager.addQueue(queue, false);
  queue->disable();  // as nodelet 1.10.0 does before onInit
  openQueue(*queue);
  const auto call = boost::make_shared<Call>();
  std::future<void> called = call->called.get_future();
  queue->addCallback(call);
  EXPECT_EQ(called.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  manager.stop();
}

TEST(OpenQueue, AQueueOfAnotherKindStaysAsItIs) {
  ros::CallbackQueue queue;
  openQueue(queue);
  EXPECT_TRUE(queue.isEnabled());
}

}  // namespace
}  // namespace fail_aware::open_queue_test
